"""Lights and shading, which PyVista and the browser share."""

from .description import Actor

# A key light from the upper left and a soft fill from the right, both tied to the camera.
LIGHTS = (((-0.5, 0.7, 1.0), 0.82), ((0.9, -0.1, 0.6), 0.34))
AMBIENT, DIFFUSE = 0.16, 1.0
SOFT_AMBIENT, SOFT_DIFFUSE = 0.36, 0.75
"""Softer light for materials, whose images contain shadows already."""


def shading(actor: Actor) -> tuple[float, float]:
    """Return the ambient and the diffuse coefficient of an actor."""
    return (AMBIENT, DIFFUSE) if actor.materials is None else (SOFT_AMBIENT, SOFT_DIFFUSE)
