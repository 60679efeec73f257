"""Family of skins that a sensor draws from: a scene's skins under touches anywhere on cells."""

from __future__ import annotations

from functools import lru_cache

from ..dataset.dataset_plan import Plan
from ..dataset.skin_model import reduced
from ..models.reduced.reduced_model import Reduced
from ..scene.draw_distributions import Fixed, Uniform
from ..scene.pixel_grid import Pressing
from ..scene.randomisation import DrawnPress, Randomisation, Session
from ..scene.scene import Scene

STRONGEST = 6.0
"""Largest factor on c that training includes; a scene that names larger ones extends it."""
SMALLEST, LARGEST = 0.25, 0.5
"""Smallest touch in training over a pixel's side, and the largest over the skin's shorter side."""
TOUCHES = 0.05, 0.45, 0.5
FAMILIES_KEPT = 8

NOMINAL = Session(
    sheet_resistance=Fixed(value=1.0),
    sheet_mismatch=Fixed(value=1.0),
    unevenness=0.0,
    capacitance=Fixed(value=1.0),
    foam_spread=0.0,
    loss_tangent=Fixed(value=0.0),
    contact_resistance=Fixed(value=1.0),
    stray_capacitance=Fixed(value=0.0),
    lead_resistance=Fixed(value=0.0),
)
"""Session without any variation."""


def family_scene(scene: Scene, drawn: bool) -> Scene:
    """The scene with the random touches and skins that its family is trained on.

    drawn: True if skins vary as in `dataset.session`. Presses by depth or force become factors:
    cells take the factors that these cause.
    """
    press, own = scene.press, scene.dataset.press
    if not press.by_factor:
        press = Pressing(factor_spread=press.factor_spread, finger=press.finger)
    length, width = scene.skin.sides
    pixel = min(length / scene.pixels.columns, width / scene.pixels.rows)
    touch = DrawnPress(
        touches=TOUCHES,
        place="anywhere",
        size=Uniform(low=SMALLEST * pixel, high=LARGEST * min(length, width)),
        cells_per_pixel=own.cells_per_pixel,
        factor=Uniform(low=1.0, high=highest_factor(scene)),
        finger=own.finger,
        without_press=own.without_press,
    )
    session = scene.dataset.session if drawn else NOMINAL
    changed = {"press": press, "dataset": Randomisation(press=touch, session=session)}
    return scene.model_copy(update=changed)


def highest_factor(scene: Scene) -> float:
    """Largest factor on c that the family of a scene is trained on."""
    return max(STRONGEST, scene.dataset.press.factor.high)


@lru_cache(maxsize=FAMILIES_KEPT)
def trained_family(scene: Scene, rtol: float) -> Reduced:
    """Reduced model of a `family_scene`, trained once per process.

    Raises InputError for a scene that cannot be reduced, ToleranceError if rtol is not reached.
    """
    Plan(scene, 1, 0, rtol)
    return reduced(scene, rtol)
