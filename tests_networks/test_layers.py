"""Each head has the layers that its paper describes, counted by hand."""

from itertools import pairwise

import pytest
import torch
from torch import nn

from cutcell_lab.networks import HEADS, SIZES, create_network, parameter_count
from cutcell_lab.networks.heads.heads import MADE


def made(head: str, size: str) -> nn.Module:
    """Return a network without its numbers, however large."""
    make, sizes = MADE[head]
    with torch.device("meta"):
        return make(*sizes[size])


def linear(before: int, after: int) -> int:
    return before * after + after


def normed(*widths: int) -> int:
    """Linear layers, each with a normalisation of two numbers a feature."""
    return sum(linear(a, b) + 2 * b for a, b in pairwise(widths))


def attention(width: int) -> int:
    """Count queries, keys, values and output; two linear layers; two normalisations."""
    ends = linear(width, 4 * width) + linear(4 * width, width)
    return 4 * linear(width, width) + ends + 4 * width


def linears(module: nn.Module) -> list[tuple[int, int]]:
    return [(m.in_features, m.out_features) for m in module.modules() if type(m) is nn.Linear]


def test_rignet_has_the_published_layers():
    network = made("rignet", "full")
    assert linears(network.first) == [(43, 128), (128, 64)]
    assert [unit.both[0].out_features for unit in network.units] == [512, 256, 256]
    assert [unit.ring[0].in_features for unit in network.units] == [128, 1024, 512]
    assert linears(network.whole)[-1][1] == 1024
    assert linears(network.last) == [(1280, 1024), (1024, 512), (512, 5)]


def test_rignet_has_3_7_million_parameters():
    units = sum(
        2 * normed(2 * a, b // 2, b // 2) + normed(b, b)
        for a, b in ((64, 512), (512, 256), (256, 256))
    )
    whole = normed(512, 512, 1024)
    count = normed(43, 128, 64) + units + whole + normed(1280, 1024, 512) + linear(512, 5)
    assert parameter_count(made("rignet", "full")) == count == 3_705_285


def test_unirig_has_the_published_layers():
    network = made("unirig", "full")
    assert (len(network.bone_rounds), len(network.point_rounds)) == (8, 16)
    assert linears(network.prior) == [(1, 16)]
    assert linears(network.both) == [(32, 16)]
    assert linears(network.weigh) == [(16, 512), *[(512, 512)] * 3, (512, 1)]
    head = 24 * attention(768) + normed(6, 768, 768) + 2 * linear(768, 768 * 16) + 2 * 16
    head += normed(1, 16) + normed(32, 16) + normed(16, *[512] * 4) + linear(512, 1)
    assert parameter_count(network) - parameter_count(network.encoder) == head


def test_puppeteer_has_the_described_layers():
    network = made("puppeteer", "full")
    assert linears(network.fuse) == [(1024, 512), (512, 512)]
    head = 12 * attention(512) + normed(6, 512, 512) + 17 * 8 + 1
    head += linear(1024, 512) + linear(512, 512)
    assert parameter_count(network) - parameter_count(network.encoder) == head


@pytest.mark.parametrize("head", HEADS)
def test_sizes_grow(head):
    counts = [parameter_count(made(head, size)) for size in SIZES]
    assert counts[0] < 100_000 < counts[1] < 2_000_000 < counts[2]


def test_the_seed_alone_decides_the_first_parameters():
    torch.manual_seed(5)
    one = create_network("puppeteer", seed=3).state_dict()
    before = torch.get_rng_state()
    other = create_network("puppeteer", seed=3).state_dict()
    assert torch.equal(torch.get_rng_state(), before)
    assert all(torch.equal(one[key], other[key]) for key in one)
    third = create_network("puppeteer", seed=4).state_dict()
    assert not torch.equal(one["fuse.0.weight"], third["fuse.0.weight"])
