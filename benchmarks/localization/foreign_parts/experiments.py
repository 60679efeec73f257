"""Columns of the paper's sheet, 6x6 pixels and positions of designed skins, on foreign twins."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from rcskin.benchmarks.accuracy.three_dimensions_parts.lines import Grid
from rcskin.benchmarks.localization.design_parts.goals import GOALS
from rcskin.benchmarks.localization.design_parts.searching import searched
from rcskin.benchmarks.localization.foreign_parts.effects import (
    ALL,
    EFFECTS,
    OWN,
    WITH_BODY,
    Effect,
)
from rcskin.benchmarks.localization.foreign_parts.experiment import Experiment
from rcskin.benchmarks.localization.foreign_parts.localizers import (
    ALL_FEATURES,
    TERMS,
    WAS,
    WIDER,
    Way,
)
from rcskin.benchmarks.localization.twin_parts.scenes import believed
from rcskin.benchmarks.localization.twin_parts.training import CHANGE, WHOLE
from rcskin.benchmarks.localization.twin_parts.trials import (
    ONE,
    SINGLE,
    Trial,
    anywhere,
    every_pixel,
)
from rcskin.simulator.scene.scene_files import load_scene

COLUMNS_GOAL = 0.97
PIXELS_GOAL = 0.83
"""Three points below the mean of own twins, see `results/twin_design.md`."""
POSITIONS_GOAL = 3.5
"""Median distance, mm."""
SIDE, FEW = 5, 2
"""Pixels along a side."""
SWEEPS, MORE_SWEEPS, FEW_SWEEPS = 6000, 12_000, 600
"""Numbers of training sweeps: for columns, for designed skins, and for a quick pass."""
COARSE = Grid(finest=0.5, order=2, far=5.0)
"""Three-dimensional solve of a quick pass."""
COLUMN_WAYS = (
    Way("as it was", WAS),
    Way("with terms", TERMS),
    Way("drawn wider", WIDER),
    Way("adapted", TERMS, touches=2),
    Way("by the curve", TERMS, quantities=WHOLE),
    Way("gaussian", TERMS, "gaussian", ALL_FEATURES),
    Way("gaussian, drawn wider", WIDER, "gaussian", ALL_FEATURES),
)
PIXEL_WAYS = (
    Way("gaussian, as it was", WAS, "gaussian", ALL_FEATURES),
    Way("gaussian, with terms", TERMS, "gaussian", ALL_FEATURES),
)
POSITION_WAYS = (
    Way("network, as it was", WAS, "network", WHOLE),
    Way("network, with terms", TERMS, "network", WHOLE),
    Way("kernel-ridge, as it was", WAS, "kernel-ridge", CHANGE),
    Way("kernel-ridge, with terms", TERMS, "kernel-ridge", CHANGE),
)


def columns(quick: bool, searches: Path) -> Experiment:
    """Columns of the paper's sheet by the paper's localizer; no skin is searched for."""
    side, order = (FEW, every_pixel(3)) if quick else (SIDE, every_pixel(1))
    scene = believed(ONE, side, SINGLE)
    trial = Trial("column", scene, "column", order, ("ksvm-ovo",), COLUMNS_GOAL, training=SWEEPS)
    title = "Columns found on {skins} skins of a three-dimensional solve, % (answered)"
    cases = tuple((effect, COLUMN_WAYS) for effect in EFFECTS)
    found = Experiment("foreign_twin", title, trial, cases, SWEEPS)
    few = tuple((effect, COLUMN_WAYS[:2]) for effect in (OWN, WITH_BODY))
    return replace(found, cases=few, sweeps=FEW_SWEEPS, grid=COARSE) if quick else found


def pixels(quick: bool, searches: Path) -> Experiment:
    """Pixels of the designed skin with 6x6 of them."""
    trial = replace(_designed("pixel", quick, searches), goal=PIXELS_GOAL)
    title = "Pixels found on {skins} skins of a three-dimensional solve, as designed, % (answered)"
    found = Experiment("foreign_twin_pixels", title, trial, _cases(PIXEL_WAYS, ALL), MORE_SWEEPS)
    return _quick(found, PIXEL_WAYS) if quick else found


def positions(quick: bool, searches: Path) -> Experiment:
    """Positions of touches of 24 mm on the skin designed for them."""
    trial = replace(_designed("position", quick, searches), goal=POSITIONS_GOAL)
    title = (
        "Median distance of answers from touches on {skins} skins of a three-dimensional solve, "
        "as designed, mm (answered)"
    )
    cases = _cases(POSITION_WAYS, WITH_BODY)
    found = Experiment("foreign_twin_positions", title, trial, cases, MORE_SWEEPS)
    return _quick(found, POSITION_WAYS[2:]) if quick else found


EXPERIMENTS: dict[str, Callable[[bool, Path], Experiment]] = {
    "columns": columns,
    "pixels": pixels,
    "positions": positions,
}


def _designed(goal: str, quick: bool, searches: Path) -> Trial:
    """The trial of a goal on the skin that `rcskin design` finds; a quick pass searches none."""
    if quick:
        small = GOALS[goal].quick().trial
        return replace(small, order=anywhere(5) if small.placed else small.order)
    wanted = GOALS[goal]
    found = searched(wanted.trial.believed, wanted.asked, searches) / "design.toml"
    return replace(wanted.trial, believed=load_scene(found))


def _cases(ways: tuple[Way, ...], effect: Effect) -> tuple[tuple[Effect, tuple[Way, ...]], ...]:
    """Twins of the training model for localizers without surroundings, and an effect for all."""
    return (OWN, tuple(way for way in ways if way.training == WAS)), (effect, ways)


def _quick(experiment: Experiment, ways: tuple[Way, ...]) -> Experiment:
    """The same with few sweeps, on a coarse grid."""
    cases = _cases(ways, experiment.cases[-1][0])
    return replace(experiment, cases=cases, sweeps=FEW_SWEEPS, grid=COARSE)
