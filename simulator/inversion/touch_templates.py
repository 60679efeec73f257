"""Templates of a scene's touches, for localizers that invert the simulator.

All values are changes from the baseline in the order of `observed`, as arrays that do not depend on
the simulator. Strengths are factors of capacitance; each represents a normal distribution around it
with a common deviation, and together they are the prior.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Real
from ..measure.experiment import own_presses
from ..measure.readout import errors_of
from ..mesh.pixel_coverage import pixel_coverage
from ..models.reduced.forward import Forward
from ..models.terminals import reduced_for
from ..press.batch import NOTHING, PressBatch, TouchedCells
from ..press.finger import finger_capacitance
from ..press.parts import parts_of
from ..press.touch import Touch
from ..scene.parts import Plan, Pressing, SceneParts, Skin
from ..scene.randomisation import Randomisation
from ..scene.supports import require, supported
from .position_tables import cells_per_pixel, position_tables
from .unknown_skin import UnknownSkin

OVERLAP = 0.5
"""Standard deviation of each value over the step to the next: their sum is flat to 1 %."""


def normal_mixture(
    quantile: Callable[[NDArray], NDArray], count: int
) -> tuple[NDArray, NDArray, float]:
    """Values at `count` equal steps of a distribution, their probabilities and their deviation."""
    draws = quantile((np.arange(2000) + 0.5) / 2000)
    low, high = quantile(np.array([0.0, 1.0]))
    if not high > low:
        return np.array([low]), np.ones(1), 0.0
    edges = np.linspace(low, high, count + 1)
    counts, _ = np.histogram(draws, edges)
    step = edges[1] - edges[0]
    return (edges[:-1] + edges[1:]) / 2, np.maximum(counts, 1) / counts.sum(), OVERLAP * step


COUNT = 6
"""Number of capacitances, where they are drawn."""


class PixelTouch(NamedTuple):
    """One touch of a pixel: factor, capacitance of the finger in F, and probability.

    presses: True if the touch presses; its factor is uncertain then.
    """

    factor: float
    finger: float
    chance: float
    presses: bool


class FingerPrior(NamedTuple):
    """Prior of a finger.

    capacitance: F, with the probability of each (`chance`), shape (finger,). deviation: of each, F.
    alone: share of touches that do not press.
    """

    capacitance: Real
    chance: Real
    deviation: float
    alone: float

    def pixel_touches(self, factors: Real, chances: Real) -> list[PixelTouch]:
        """All touches of a pixel, those that press first; their probabilities sum to 1."""
        each = list(zip(self.capacitance.tolist(), self.chance.tolist(), strict=True))
        pressed = [
            PixelTouch(factor, C, (1 - self.alone) * by_factor * by_C, True)
            for factor, by_factor in zip(factors.tolist(), chances.tolist(), strict=True)
            for C, by_C in each
        ]
        return pressed + [PixelTouch(1.0, C, self.alone * p, False) for C, p in each if self.alone]


def finger_prior(skin: Skin, plan: Plan, presses: str) -> FingerPrior:
    """Fingers of [dataset.press] or, for presses "press", the finger of [press]."""
    drawn = plan.draws.press
    if presses == "dataset" and drawn.finger is not None:
        return FingerPrior(*normal_mixture(drawn.finger.at, COUNT), drawn.without_press or 0.0)
    alone = (drawn.without_press or 0.0) if presses == "dataset" else 0.0
    return FingerPrior(np.array([_own(skin, plan.press)]), np.ones(1), 0.0, alone)


def _own(skin: Skin, pressing: Pressing) -> float:
    """The finger of the scene's `press` on a whole pixel, F; 0 for a rod."""
    how = pressing.finger
    return finger_capacitance(skin, Touch(1, 1, 1.0), how) if how else 0.0


Tables = dict[str, NDArray]
STRENGTHS = 11
"""Number of strengths of a touch; their normal distributions cover factors from 1.3 to 4.5."""
RTOL = 1e-3
"""Tolerance of Rs and Cp: a meter's noise is several times larger."""
DRIFT = 1e-3
"""Residual drift after a line through the nearest baseline sweeps, where presses change a skin by
5e-4."""
POSITION = "position"
TWO_TOUCHES = ("touches", "pair")


def templates(
    parts: SceneParts,
    target: str,
    presses: str = "dataset",
    baseline: Real | None = None,
    averaged: int = 1,
    drift: float = DRIFT,
) -> Tables:
    """Tables of a scene, for a localizer of a target.

    presses: "dataset" for strengths of [dataset.press], "press" for those of [press]. baseline:
    mean of `averaged` baseline sweeps in the order of `observed`, shape (number,), from which the
    skin is estimated; without it the skin is the mean of the sessions, with their uncertainty.
    drift: relative standard deviation of changes of foam and sheets between the baseline and a
    touch. All tables have deviation (number,): of one reading by the meter; drift (number, 2):
    effect of drifting foam and sheets, if there is a baseline; chances (3,): of 0, 1, 2 touches;
    strengths (strength,), weights and spread (): the prior; weights are of strengths with each
    possible finger, (strength,). For pixels: grid (2,): rows and columns; pixels (place, 2): row
    and column; single (place, strength, number): a touch; slope, same shape: derivative by
    strength; skin (place, strength, number, unknown): effect of one deviation of each unknown of
    the skin, and of drift; shift (place, strength, number): known effect of the skin. For two
    touches also pairs (pair, 2): places, and pair (pair, strength, strength, number). For
    positions: see `position_tables`. Raises InputError for a meter without noise, and as
    `require` does for more than one touch and for positions.
    """
    if target in (POSITION, *TWO_TOUCHES):
        plan = parts.plan if presses == "dataset" else replace(parts.plan, draws=Randomisation())
        use = "a localizer by a model of the skin for two touches or positions"
        require(use, parts.skin, None, plan)
    if baseline is None:
        return _of_mean_skin(parts, target, presses)  # pyright: ignore[reportArgumentType]
    unknown = _unknown_skin(parts, target == POSITION)  # pyright: ignore[reportArgumentType]
    return _tables(unknown.conditioned_on_baseline(baseline, averaged), target, presses, drift)


@lru_cache(maxsize=8)
def _of_mean_skin(parts: SceneParts, target: str, presses: str) -> Tables:
    unknown = _unknown_skin(parts, target == POSITION)  # pyright: ignore[reportArgumentType]
    return _tables(unknown, target, presses, 0.0)


def _tables(unknown: UnknownSkin, target: str, presses: str, drift: float) -> Tables:
    parts = unknown.forward.parts
    touched = parts.plan.draws.press.touches
    chances = np.zeros(3)
    chances[: len(touched)] = touched
    strengths, weights, spread = strength_prior(parts.skin, parts.plan, presses)
    fingers = finger_prior(parts.skin, parts.plan, presses)
    touches = fingers.pixel_touches(strengths, weights)
    common = {
        "deviation": errors_of(parts.setup, parts.meter, unpressed=unknown.unpressed).deviation,
        "chances": chances,
        "strengths": strengths,
        "weights": np.array([touch.chance for touch in touches]),
        "spread": np.array(spread),
    }
    of_touches = (
        position_tables(unknown, strengths)
        if target == POSITION
        else pixel_tables(unknown, touches, fingers.deviation)
    )
    tables = common | of_touches | _with_drift(of_touches["skin"], unknown, drift)
    return tables | pair_tables(unknown, strengths) if target in TWO_TOUCHES else tables


def _with_drift(skin: Real, unknown: UnknownSkin, drift: float) -> Tables:
    columns = unknown.drift(drift) if drift else np.zeros((skin.shape[-2], 0))
    everywhere = np.broadcast_to(columns, (*skin.shape[:-1], columns.shape[-1]))
    return {"skin": np.concatenate([skin, everywhere], axis=-1), "drift": columns}


@lru_cache(maxsize=8)
def _unknown_skin(parts: SceneParts, anywhere: bool) -> UnknownSkin:
    supported("a localizer by a model of the skin", parts)
    cells = cells_per_pixel(parts.skin, parts.plan) if anywhere else 1
    return UnknownSkin(Forward(parts, cells, rtol=RTOL, train=reduced_for))


def strength_prior(skin: Skin, plan: Plan, presses: str) -> tuple[NDArray, NDArray, float]:
    """Strengths, the probability of each, and their common deviation."""
    drawn, depth = plan.draws.press.factor_within(skin.foam), plan.draws.press.depth
    if presses == "press":
        return normal_mixture(own_presses(skin, plan.press).at, STRENGTHS)
    if plan.press.by_factor or depth is None:
        return normal_mixture(drawn.at, STRENGTHS)
    return normal_mixture(lambda chance: skin.pressed_factors(depth.at(chance)), STRENGTHS)


def pixel_tables(unknown: UnknownSkin, touches: Sequence[PixelTouch], of_finger: float) -> Tables:
    """Tables of all touches of every single pixel. of_finger: deviation of its capacitance, F."""
    forward, pixels = unknown.forward, unknown.forward.parts.skin.pixels
    unpressed = unknown.observed(forward.slopes(NOTHING, unknown.values).Z)
    places = pixel_coverage(forward.parts.skin).numbers
    found = [
        [_touch(unknown, pixel, touch, of_finger) for touch in touches] for pixel in places.tolist()
    ]
    single, slope, skin, shift = (
        np.array([[touch[k] for touch in touches] for touches in found]) for k in range(4)
    )
    return {
        "grid": np.array([pixels.rows, pixels.columns]),
        "pixels": np.stack(np.divmod(places, pixels.columns), axis=1) + 1,
        "single": single - unpressed,
        "slope": slope,
        "skin": skin,
        "shift": shift,
    }


def _touch(
    unknown: UnknownSkin, pixel: int, touch: PixelTouch, of_finger: float
) -> tuple[NDArray, ...]:
    """Observed values of a touch, slope by strength, effect of the unknown skin, and shift.

    An uncertain capacitance of a finger is one more unknown of the touch.
    """
    cells, rises = np.array([pixel]), np.array([touch.factor - 1])
    if touch.finger or of_finger:
        own = parts_of(unknown.forward.parts.skin).finger(cells)
        cells, rises = np.append(cells, own), np.append(rises, touch.finger)
    response = unknown.forward.slopes(TouchedCells(cells, rises), unknown.values)
    slope = touch.presses * unknown.observed_slope(response.Z, response.by_rise[..., pixel])
    skin, shift = unknown.of_touch(cells, rises)
    if of_finger:
        by_finger = of_finger * unknown.observed_slope(response.Z, response.by_parameter["finger"])
        skin = np.column_stack([skin, by_finger])
    return unknown.observed(response.Z), slope, skin, shift


def pair_tables(unknown: UnknownSkin, strengths: Real) -> Tables:
    """Tables of all pairs of pixels at all pairs of strengths."""
    places = pixel_coverage(unknown.forward.parts.skin).numbers
    pairs = np.stack(np.triu_indices(len(places), 1), axis=1)
    first, second = np.meshgrid(strengths - 1, strengths - 1, indexing="ij")
    rises = np.stack([first.ravel(), second.ravel()], axis=1)
    cells = np.repeat(places[pairs], len(rises), axis=0)
    batch = PressBatch.even(cells, np.tile(rises, (len(pairs), 1)))
    Z = unknown.forward.solve(batch, unknown.values)
    unpressed = unknown.forward.slopes(NOTHING, unknown.values).Z
    change = unknown.observed(Z) - unknown.observed(unpressed)
    return {"pairs": pairs, "pair": change.reshape(len(pairs), *first.shape, -1)}
