"""All heads: rigs in, weights out, whatever is padded and in whatever order joints come."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from cutcell.errors import ParameterError
from cutcell_lab.networks import HEADS, collate, create_network, predict


def stirred(head: str, seed: int = 0) -> torch.nn.Module:
    """Return a network whose parameters all differ from zero, as if it had learned."""
    network = create_network(head, seed=seed).eval()
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        for parameter in network.parameters():
            parameter.data += 0.1 * torch.randn_like(parameter)
    return network


def reordered(sample, order):
    """Return the same rig with its joints in another order."""
    place = np.argsort(order)
    parents = sample.parents[order]
    return replace(
        sample,
        joints=sample.joints[order],
        tails=sample.tails[order],
        parents=np.where(parents >= 0, place[parents], -1),
        prior=None if sample.prior is None else sample.prior[:, order],
        target=sample.target[:, order],
        deform=sample.deform[order],
    )


@pytest.mark.parametrize("prior", [True, False])
@pytest.mark.parametrize("head", HEADS)
def test_weights_are_weights(head, prior, two):
    samples = two if prior else [sample.with_prior(None) for sample in two]
    for sample, weights in zip(samples, predict(stirred(head), samples), strict=True):
        assert weights.shape == (len(sample.points), len(sample.joints))
        assert (weights >= 0).all()
        np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-9)


@pytest.mark.parametrize("head", HEADS)
def test_padding_changes_nothing(head, two):
    network = stirred(head)
    with torch.no_grad():
        together = network(collate(two)).numpy()
        for row, sample in zip(together, two, strict=True):
            points, joints = len(sample.points), len(sample.joints)
            alone = network(collate([sample]))[0].numpy()
            np.testing.assert_allclose(row[:points, :joints], alone, atol=2e-5)
            assert not row[points:].any()
            assert not row[:, joints:].any()


@pytest.mark.parametrize("prior", [True, False])
@pytest.mark.parametrize("head", HEADS)
def test_the_order_of_joints_does_not_matter(head, prior, biped, rng):
    sample = biped if prior else biped.with_prior(None)
    order = rng.permutation(len(sample.joints))
    network = stirred(head)
    (one,), (other,) = predict(network, [sample]), predict(network, [reordered(sample, order)])
    np.testing.assert_allclose(other, one[:, order], atol=2e-5)


@pytest.mark.parametrize("head", HEADS)
def test_names_do_not_matter(head, biped):
    network = stirred(head)
    (one,), (other,) = predict(network, [biped]), predict(network, [replace(biped, name="x")])
    np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("head", HEADS)
def test_the_prior_matters(head, biped):
    flipped = replace(biped, prior=biped.prior[:, ::-1].copy())
    (one,), (other,) = (predict(stirred(head), [sample]) for sample in (biped, flipped))
    assert np.abs(one - other).sum(axis=1).mean() > 0.01


def test_a_new_unirig_gives_the_prior(biped):
    (weights,) = predict(create_network("unirig"), [biped])
    prior = biped.prior / biped.prior.sum(axis=1, keepdims=True)
    assert np.abs(weights - prior).sum(axis=1).max() < 0.05


def test_rignet_takes_the_five_joints_that_the_prior_ranks_first(biped, rng):
    prior = rng.random(biped.prior.shape).astype(np.float32)
    sample = replace(biped, prior=prior)
    with torch.no_grad():
        weights = stirred("rignet")(collate([sample]))[0].numpy()
    best = np.argsort(-prior, axis=1)[:, :5]
    some = np.zeros(weights.shape, bool)
    np.put_along_axis(some, best, True, axis=1)
    np.testing.assert_array_equal(weights > 0, some)


def test_rignet_takes_fewer_joints_where_there_are_fewer(biped):
    few = replace(
        biped,
        joints=biped.joints[:2],
        tails=biped.tails[:2],
        parents=np.array([-1, 0]),
        prior=np.full((len(biped.points), 2), 0.5, np.float32),
        target=None,
    )
    (weights,) = predict(stirred("rignet"), [few])
    np.testing.assert_allclose(weights.sum(axis=1), 1)
    both = collate([biped, replace(few, target=np.eye(2, dtype=np.float32)[[0] * len(few.points)])])
    assert torch.isfinite(stirred("rignet").loss(both))


@pytest.mark.parametrize("head", HEADS)
def test_every_parameter_has_a_gradient(head, two):
    network = stirred(head).train()
    network.loss(collate(two)).backward()
    for name, parameter in network.named_parameters():
        assert parameter.grad is not None, name
        assert torch.isfinite(parameter.grad).all(), name
    without = [n for n, p in network.named_parameters() if not p.grad.any()]
    # What a softmax or a normalisation takes away again has none.
    assert all(name.endswith(("bias", "in_proj_bias")) for name in without), without


def test_gradients_are_those_of_differences():
    from cutcell_lab.networks.heads.layers import weight_loss

    batch, logits = small_batch()
    torch.autograd.gradcheck(
        lambda x: weight_loss(torch.softmax(x, 2), batch), logits, eps=1e-6, atol=1e-5
    )


def small_batch():
    """Return a batch of two points and three joints in float64, and logits."""
    from types import SimpleNamespace

    generator = torch.Generator().manual_seed(1)
    target = torch.tensor([[[0.5, 0.5, 0.0], [0.0, 0.3, 0.7]]], dtype=torch.float64)
    mask = torch.ones(1, 2, dtype=torch.bool)
    batch = SimpleNamespace(
        target=target,
        below=torch.tensor([[[1.0, 1, 1], [0, 1, 1], [0, 0, 1]]], dtype=torch.float64),
        points=torch.rand(1, 2, 3, generator=generator, dtype=torch.float64),
        joints=torch.rand(1, 3, 3, generator=generator, dtype=torch.float64),
        joint_mask=torch.ones(1, 3, dtype=torch.bool),
        flat=lambda x: x[mask],
    )
    logits = torch.randn(1, 2, 3, generator=generator, dtype=torch.float64, requires_grad=True)
    return batch, logits


def test_the_loss_of_the_truth_is_its_entropy_alone():
    from cutcell_lab.networks.heads.layers import weight_loss

    batch, _ = small_batch()
    entropy = -(batch.target * batch.target.clamp(min=1e-9).log()).sum(2).mean()
    torch.testing.assert_close(weight_loss(batch.target, batch), entropy)


def test_unknown_heads_and_sizes_are_named():
    with pytest.raises(ParameterError, match="head"):
        create_network("transformer")
    with pytest.raises(ParameterError, match="size"):
        create_network("rignet", "huge")
