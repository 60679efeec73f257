"""What the report needs of the simulator, given as functions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray


class ReadingError(NamedTuple):
    """Standard deviation of one reading: of |Z|, as a fraction, and of the phase, rad."""

    magnitude: float
    phase: float


class Cause(NamedTuple):
    """A parameter, and how much of the misfit goes when it alone is fitted, from 0 to 1."""

    parameter: str
    share: float


class Estimate(NamedTuple):
    """A number of the scene as it stood and as calibrated, with its 95 % interval."""

    name: str
    unit: str
    start: float
    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Recalibrated:
    """Simulated sweeps of the calibrated scene, free of noise, and what was calibrated."""

    sweeps: xr.Dataset
    estimates: Sequence[Estimate]


@dataclass(frozen=True)
class Simulation:
    """Scenes are given as TOML text; each function raises InputError where it cannot answer.

    scene: text of the scene of a name or path.
    reading_error: of the scene's meter; None where it is without noise.
    resimulated: the same presses on a scene at frequencies in Hz, free of noise.
    read: sweeps as the scene's meter shows them, session by session, by seed.
    recalibrated: the presses of sweeps simulated of a scene (their attribute `scene`), on the scene
        calibrated to the other sweeps.
    explained: what parts sweeps from a scene, the greatest share first.
    """

    scene: Callable[[str], str]
    reading_error: Callable[[str], ReadingError | None]
    resimulated: Callable[[xr.Dataset, str, NDArray], xr.Dataset]
    read: Callable[[xr.Dataset, str, int], xr.Dataset]
    recalibrated: Callable[[xr.Dataset, xr.Dataset], Recalibrated]
    explained: Callable[[str, xr.Dataset], Sequence[Cause]]


@dataclass(frozen=True)
class Style:
    """How charts are drawn: a figure written to a path, an axis of frequencies in kHz, colours.

    checked_ending: the ending of charts by its name, such as svg; raises InputError.
    """

    chart: Callable[[Path, float, float], AbstractContextManager[Figure]]
    frequency_axis: Callable[[Axes], Any]
    colours: Sequence[str]
    checked_ending: Callable[[str], str]
