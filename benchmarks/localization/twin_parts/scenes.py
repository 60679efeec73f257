"""The scenes of the twin experiment: what a localizer believes of a skin, and what the twin is.

The twin of a column skin has, at its far edge, a pair of foils that floats and that the localizer's
scene knows nothing of; with two interfaces the pair that is not driven floats, as the scene says.
"""

from __future__ import annotations

from rcskin.simulator.scene.contacts import Contact
from rcskin.simulator.scene.pixel_grid import Pixels
from rcskin.simulator.scene.randomisation import (
    DrawnPress,
    Fixed,
    Lognormal,
    Normal,
    Randomisation,
    Session,
    Uniform,
)
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

SWEEPS_PER_SESSION, BETWEEN_RESTS = 60, 5
"""Of recordings and of training: presses, after which the skin is read at rest."""
STRENGTH = Normal(mean=2.0, deviation=0.15)
"""Of presses, in training: a hand that doubles the capacitance, more or less."""
OFFSET = 0.1
"""Of a hand, over the side of a pixel."""
PLACED_SIZE = Fixed(value=0.024)
"""Of touches anywhere, m: squares of this side."""
CELLS_PER_PIXEL = 3
SKINS = Session(
    sweeps_per_session=SWEEPS_PER_SESSION,
    rest_every=BETWEEN_RESTS,
    sheet_resistance=Lognormal(median=1.0, spread=0.15),
    sheet_mismatch=Lognormal(median=1.0, spread=0.05),
    unevenness=0.04,
    capacitance=Normal(mean=1.0, deviation=0.08),
    foam_spread=0.02,
    foam_pattern="smooth",
    loss_tangent=Uniform(low=0.0, high=0.02),
    stray_capacitance=Uniform(low=0.0, high=2e-12),
    lead_resistance=Uniform(low=0.0, high=5.0),
)
"""How far skins are from nominal: a localizer knows the spread, and none of the twins."""
FAR_FOILS = ("top", "bottom")


def believed(base: str, pixels: int, touches: tuple[float, ...], anywhere: bool = False) -> Scene:
    """What the localizer is trained on: a built-in scene divided into pixels x pixels.

    touches: chances of 0, 1, 2 touches.
    """
    kind = (
        {"place": "anywhere", "shape": ("rectangle",), "size": PLACED_SIZE}
        if anywhere
        else {"offset": OFFSET, "cells_per_pixel": CELLS_PER_PIXEL}
    )
    press = DrawnPress(touches=touches, factor=STRENGTH, **kind)
    return load_scene(base).model_copy(
        update={
            "name": f"{base} with {pixels}x{pixels} pixels",
            "pixels": Pixels(rows=pixels, columns=pixels),
            "dataset": Randomisation(press=press, session=SKINS),
        }
    )


def built(scene: Scene) -> Scene:
    """The twin's own scene: presses anywhere on cells, and foils at the far edge."""
    pitch = scene.skin.length / scene.pixels.columns
    press = DrawnPress(
        touches=(0.1, 0.5, 0.4),
        place="anywhere",
        shape=("rectangle",),
        size=Uniform(low=0.8 * min(pitch, 0.024), high=1.2 * max(pitch, 0.024)),
        cells_per_pixel=CELLS_PER_PIXEL,
        factor=Uniform(low=1.3, high=2.7),
    )
    foils = () if len(scene.interfaces) > 1 else tuple(map(_far_foil, FAR_FOILS))
    return scene.model_copy(
        update={
            "name": f"twin of {scene.name}",
            "contacts": (*scene.contacts, *foils),
            "dataset": Randomisation(press=press, session=SKINS),
        }
    )


def _far_foil(electrode: str) -> Contact:
    return Contact.model_validate(
        {"name": f"{electrode}-far", "electrode": electrode, "edge": "right"}
    )
