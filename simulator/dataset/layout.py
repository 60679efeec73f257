"""Arrays of a data set: the schema of sweeps, the touches, and the random draws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene.parts import Skin
from ..sweeps.reading_quantities import DESCRIBED
from ..sweeps.schema import DIMENSIONS, FAULT, LABELS
from .dataset_plan import DatasetPlan, readings
from .drawn_presses import MAX_TOUCHES
from .drawn_session import DrawnSession

SINGLE_DIGITS = 6
"""Number of decimal digits that float32 keeps."""
SWEEP, SESSION = "sweep", "drawn_session"


@dataclass(frozen=True)
class ArraySpec:
    """Specification of an array; arrays that grow have sweeps or sessions as first dimension.

    dtype: name of a numpy type, or `str`.
    """

    name: str
    dimensions: tuple[str, ...]
    dtype: str
    meaning: str
    units: str = ""
    coordinates: str = ""

    @property
    def attributes(self) -> Mapping[str, str]:
        """Attributes in the convention of xarray."""
        texts = {"long_name": self.meaning, "units": self.units, "coordinates": self.coordinates}
        return {name: text for name, text in texts.items() if text}


def variables(plan: DatasetPlan) -> list[ArraySpec]:
    """Specifications of all arrays that grow with the data set."""
    quantity = "float32" if plan.parts.meter.readout.display_digits <= SINGLE_DIGITS else "float64"
    faults = [] if plan.parts.plan.draws.session.faults is None else [FAULTS]
    labels = " ".join([*LABELS, *(each.name for each in faults)])
    return [
        *(
            ArraySpec(each.name, DIMENSIONS, quantity, each.meaning, each.units, labels)
            for each in plan.parts.setup.kind.quantities
        ),
        *(
            ArraySpec(name, (SWEEP,), "str" if name == "press" else "int64", meaning)
            for name, meaning in LABELS.items()
        ),
        *faults,
        *touch_variables(plan.parts.skin),
        *drawn_variables(plan.parts.skin),
    ]


FAULTS = ArraySpec(FAULT, (SWEEP,), "str", "fault of the skin or reader, empty if none")
TOUCHES = [
    ArraySpec("touches", (SWEEP,), "int64", "number of touches"),
    ArraySpec("touch_x", (SWEEP, "touch"), "float32", "centre of a touch, 0 if none", "m"),
    ArraySpec("touch_y", (SWEEP, "touch"), "float32", "centre of a touch, 0 if none", "m"),
    ArraySpec("touch_factor", (SWEEP, "touch"), "float32", "capacitance over that at rest", "1"),
]
FINGER = ArraySpec("touch_finger", (SWEEP, "touch"), "float32", "capacitance to earth", "F")
DRAWN = [
    ArraySpec(
        f"drawn_{name}",
        (SESSION, *dimensions),
        "float64",
        f"{meaning}, drawn for a session",
        units,
    )
    for name, dimensions, meaning, units in (
        ("top", ("wave",), "top sheet's conductance over nominal, by waves", "1"),
        ("bottom", ("wave",), "bottom sheet's conductance over nominal, by waves", "1"),
        ("films", ("contact",), "conductance of contacts over nominal", "1"),
        ("capacitance", ("foam_row", "foam_column"), "foam at rest over nominal", "1"),
        ("loss_tangent", (), "loss tangent of the foam", "1"),
        ("stray_capacitance", (), "stray capacitance of the leads, in parallel", "F"),
        ("lead_resistance", (), "resistance of the leads, in series", "ohm"),
        ("meter_gain", ("interface",), "the meter's factor on |Z|", "1"),
        ("meter_turn", ("interface",), "the meter's addition to the phase", "rad"),
        ("body", (), "bodies' capacitance over nominal", "1"),
        ("rim", (), "the rim's capacitance over nominal", "1"),
    )
]


def touch_variables(skin: Skin) -> list[ArraySpec]:
    """Arrays of touches, with their fingers if the scene has surroundings."""
    return TOUCHES if skin.around is None else [*TOUCHES, FINGER]


def drawn_variables(skin: Skin) -> list[ArraySpec]:
    """Arrays of the draws of a session, with surroundings if the scene has them."""
    if skin.around is not None:
        return DRAWN
    return [each for each in DRAWN if each.name not in ("drawn_body", "drawn_rim")]


def readings_along(plan: DatasetPlan) -> dict[str, int]:
    """Sizes of the dimensions of the readings."""
    return {
        SWEEP: plan.sweeps,
        "interface": len(plan.parts.setup.interfaces),
        "frequency": len(plan.parts.setup.frequency),
    }


def min_size(plan: DatasetPlan) -> float:
    """Smallest size of the readings in bytes: compression halves noisy values at most."""
    of_each = [np.dtype(each.dtype).itemsize for each in variables(plan) if each.name in DESCRIBED]
    return 0.5 * sum(of_each) * plan.sweeps * readings(plan.parts.setup)


def sizes(plan: DatasetPlan, grid: tuple[int, int], modes: int) -> dict[str, int]:
    """Sizes of all dimensions. grid: cells by row and column. modes: of a sheet's conductance."""
    return {
        **readings_along(plan),
        "touch": MAX_TOUCHES,
        SESSION: plan.sessions,
        "wave": modes,
        "contact": len(plan.parts.skin.contacts),
        "foam_row": grid[0],
        "foam_column": grid[1],
    }


def values(session: DrawnSession) -> dict[str, NDArray]:
    """All arrays of one whole session by name."""
    presses, skin = session.presses, session.skin
    drawn = {
        "top": skin.variation.top,
        "bottom": skin.variation.bottom,
        "films": skin.variation.films,
        "capacitance": skin.variation.capacitance,
        "loss_tangent": skin.variation.loss.tangent,
        "stray_capacitance": skin.leads.stray_capacitance,
        "lead_resistance": skin.leads.resistance,
        "meter_gain": session.gain,
        "meter_turn": session.turn,
        "body": skin.variation.body,
        "rim": skin.variation.rim,
    }
    return {
        **session.shown,
        "press": np.array(presses.text, dtype=object),
        "row": presses.row,
        "column": presses.column,
        "session": np.full(len(presses.text), session.number),
        FAULT: np.full(len(presses.text), str(session.fault or ""), dtype=object),
        "touches": presses.touches,
        "touch_x": presses.x,
        "touch_y": presses.y,
        "touch_factor": presses.factor,
        "touch_finger": presses.finger,
        **{f"drawn_{name}": np.asarray(value)[None] for name, value in drawn.items()},
    }


def joined_sessions(sessions: Sequence[dict[str, NDArray]], sweeps: int) -> dict[str, NDArray]:
    """Consecutive sessions joined, cut to `sweeps` sweeps."""
    whole = {name: np.concatenate([part[name] for part in sessions]) for name in sessions[0]}
    return {name: a if name.startswith("drawn_") else a[:sweeps] for name, a in whole.items()}
