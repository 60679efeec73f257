"""Pairs of sweeps with the same frequencies, interfaces and presses, and notes on changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.measure.simulate import resimulated
from ...simulator.scene.scene import Scene
from ...simulator.scene.scene_files import scene_of_sweeps, scene_text
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named
from ...simulator.sweeps.reading_quantities import kind_of
from ...simulator.sweeps.reading_subset import read_mask, restricted, with_named_interface
from ...simulator.sweeps.same_skin import check_same_skin, same_frequencies
from ...simulator.sweeps.schema import MEASURED, VIRTUAL
from ..inputs.features import at_interfaces

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ...simulator.arrays import Integer
    from ..model.localizer_model import Model

VIRTUAL_SERIAL = "000000000"
"""Serial number of the virtual meter; older recordings are recognized only by it."""


@dataclass(frozen=True)
class SideLabel:
    """Names of the other side in the report: `the measurement`, `measured sweeps`."""

    name: str
    adjective: str


MEASUREMENT = SideLabel("measurement", "measured")
TWIN = SideLabel("twin", "twin")
SECOND = SideLabel("second simulation", "second simulated")


def label_of_side(sweeps: xr.Dataset) -> SideLabel:
    """The label, from the attributes: `twin`, the virtual meter, or a simulation's tolerance."""
    attributes = sweeps.attrs
    virtual = VIRTUAL_SERIAL in str(attributes.get("meter", "")).split(",")
    if "twin" in attributes or virtual or attributes.get("model") == VIRTUAL:
        return TWIN
    simulated = "rtol" in attributes and attributes.get("model") != MEASURED
    return SECOND if simulated else MEASUREMENT


def check_simulated(sweeps: xr.Dataset, path: object) -> None:
    """Raises InputError if sweeps given as simulated are marked as measured."""
    if sweeps.attrs.get("model") in (MEASURED, VIRTUAL) or "twin" in sweeps.attrs:
        called = label_of_side(sweeps).adjective
        raise InputError(f"{path}: contains {called} sweeps; name the simulated sweeps first")


def check_other(sweeps: xr.Dataset, scene: str, path: object) -> None:
    """Raises InputError if the other side's sweeps are of another skin than the scene's.

    scene: TOML text, empty if unknown.
    """
    check_same_skin(str(sweeps.attrs.get("scene", "")), scene, str(path))


MAX_SWEEPS = 1000
"""Maximum number of sweeps: the cost of kernel machines grows with the square."""
SESSION_EXCESS = 2
"""The sessions drawn have this multiple of MAX_SWEEPS sweeps, so that each keeps enough of them."""
BASELINES_PER_SESSION = 5
"""Number of first unpressed sweeps that are kept of each session, as its baseline."""


def subsampled(sweeps: xr.Dataset, random: np.random.Generator) -> xr.Dataset:
    """At most MAX_SWEEPS of the sweeps, of sessions drawn at random; the unpressed ones first."""
    if sweeps.sizes["sweep"] <= MAX_SWEEPS:
        return sweeps
    session = sweeps["session"].values
    among = np.flatnonzero(np.isin(session, _drawn(session, random)))
    rest = _first_baselines(among, session, sweeps["row"].values)[:MAX_SWEEPS]
    others = np.setdiff1d(among, rest)
    more = random.choice(others, min(MAX_SWEEPS - rest.size, others.size), replace=False)
    return sweeps.isel(sweep=np.union1d(rest, more))


def _drawn(session: Integer, random: np.random.Generator) -> Integer:
    """Random sessions that together have SESSION_EXCESS times MAX_SWEEPS sweeps, or all."""
    names, counts = np.unique(session, return_counts=True)
    order = random.permutation(names.size)
    before = np.cumsum(counts[order]) - counts[order]
    return names[order[before < SESSION_EXCESS * MAX_SWEEPS]]


def _first_baselines(order: NDArray[np.intp], session: Integer, row: Integer) -> NDArray[np.intp]:
    """Indices of the first BASELINES_PER_SESSION unpressed sweeps of each session."""
    unpressed = order[row[order] == 0]
    parts = [
        unpressed[session[unpressed] == each][:BASELINES_PER_SESSION]
        for each in np.unique(session[unpressed])
    ]
    return np.concatenate([np.zeros(0, dtype=np.intp), *parts])


@dataclass(frozen=True, eq=False)
class SweepPair:
    """Simulated and other sweeps with the same interfaces and readings.

    scene: scene of the simulated skin, None if unknown. noise_free: True if the simulated sweeps
    are without the meter's errors. notes: remarks on how they were made comparable.
    """

    simulated: xr.Dataset
    other: xr.Dataset
    label: SideLabel
    scene: Scene | None
    noise_free: bool
    notes: Sequence[str] = field(default_factory=tuple)


def checked_pair(
    simulated: xr.Dataset,
    other: xr.Dataset,
    names: tuple[str, str],
    scene: Scene | None,
    model: Model | None,
    seed: int,
    *,
    any_skin: bool,
) -> SweepPair:
    """A pair of sweeps as given by a user, checked to be what they are taken for.

    names: names of both sides in error messages. scene, seed: see `pair_sweeps`. model: the model
    to be tested, whose interfaces are chosen. any_skin: True accepts sweeps of another skin. Raises
    InputError as `pair_sweeps`, if the simulated sweeps are measured ones, if the others are of
    another skin, and if they do not fit the model.
    """
    sides = simulated, other
    if model is not None:
        ours, theirs = (with_named_interface(each, model.interfaces) for each in sides)
        model.samples(theirs)
        simulated, other = (at_interfaces(each, model.interfaces) for each in (ours, theirs))
    check_simulated(simulated, names[0])
    if not any_skin:
        own = scene_text(scene) if scene else str(simulated.attrs.get("scene", ""))
        check_other(other, own, names[1])
    return pair_sweeps(simulated, other, scene, seed)


def pair_sweeps(
    simulated: xr.Dataset, other: xr.Dataset, scene: Scene | None, seed: int
) -> SweepPair:
    """Reduce both sides to their common interfaces, frequencies and readings.

    scene: None for that of the simulated sweeps. seed: seed of the subsampling. Raises InputError
    if they have no interface or pressed pixel in common, or if frequencies differ and the scene is
    unknown.
    """
    ours, theirs = (kind_of(each.variables).name for each in (simulated, other))
    if ours != theirs:
        raise InputError(
            f"the simulated sweeps hold the {ours}, the others the {theirs}; sweeps of one kind of "
            "reading can be compared"
        )
    notes: list[str] = []
    scene = scene or scene_of_sweeps(simulated)
    label, noise_free = (
        label_of_side(other),
        "readout" not in simulated.attrs and _is_noise_free(simulated),
    )
    simulated, other = (
        _single(simulated, "simulated", notes),
        _single(other, label.adjective, notes),
    )
    other = with_named_interface(other, list(map(str, simulated["interface"].values)))
    simulated = _subsampled(simulated, notes, seed)
    simulated, other = _on_common_interfaces(simulated, other, notes)
    if not _same_frequencies(simulated, other):
        simulated = _at_frequencies_of(other, simulated, scene, notes)
        noise_free = True
    other = other.assign_coords(frequency=simulated["frequency"].values)
    simulated, other = _of_common_readings(simulated, other, notes)
    _check_common_press(simulated, other)
    simulated = simulated.assign_attrs(scene=scene_text(scene) if scene else "")
    return SweepPair(simulated, other, label, scene, noise_free, notes)


def pixel_of(sweeps: xr.Dataset) -> Integer:
    """Number of the pressed pixel, the same in all sweeps, 0 for none; shape (sweep,)."""
    row, column = sweeps["row"].values, sweeps["column"].values
    return np.where(row > 0, row * 10_000 + column, 0)


def _is_noise_free(sweeps: xr.Dataset) -> bool:
    """True if the sweeps have numerical errors, as only noise-free simulated sweeps do."""
    return any(name in sweeps for name in kind_of(sweeps.variables).error_names)


def _single(sweeps: xr.Dataset, called: str, notes: list[str]) -> xr.Dataset:
    """Sweeps with a single pressed pixel, or with none."""
    alone = (sweeps["row"].values >= 0) & (sweeps["column"].values >= 0)
    if not alone.any():
        raise InputError(
            f"none of the {called} sweeps is of a single pixel or of the unpressed skin"
        )
    if not alone.all():
        notes.append(f"{np.sum(~alone)} {called} sweeps of no single pixel are left out.")
    return sweeps.isel(sweep=alone)


def _subsampled(sweeps: xr.Dataset, notes: list[str], seed: int) -> xr.Dataset:
    kept = subsampled(sweeps, np.random.default_rng(seed))
    if kept.sizes["sweep"] < sweeps.sizes["sweep"]:
        numbers = f"{kept.sizes['sweep']} of {sweeps.sizes['sweep']}"
        notes.append(f"{numbers} simulated sweeps are used, drawn at random.")
    return kept


def _on_common_interfaces(
    simulated: xr.Dataset, other: xr.Dataset, notes: list[str]
) -> tuple[xr.Dataset, xr.Dataset]:
    names, others = ([str(n) for n in part["interface"].values] for part in (simulated, other))
    common = [name for name in names if name in others]
    if not common:
        raise InputError(f"no interface in common: {', '.join(names)} and {', '.join(others)}")
    left_out = sorted({*names, *others} - {*common})
    if left_out:
        notes.append(f"Interfaces that only one side has are left out: {', '.join(left_out)}.")
    return simulated.sel(interface=common), other.sel(interface=common)


def _same_frequencies(simulated: xr.Dataset, other: xr.Dataset) -> bool:
    f, g = simulated["frequency"].values, other["frequency"].values
    return f.size == g.size and bool(same_frequencies(f, g).all())


def _at_frequencies_of(
    other: xr.Dataset, simulated: xr.Dataset, scene: Scene | None, notes: list[str]
) -> xr.Dataset:
    f, g = (part["frequency"].values for part in (simulated, other))
    if scene is None:
        raise InputError(
            f"the simulated sweeps have {f.size} frequencies of {f[0]:.6g} to {f[-1]:.6g} Hz, the "
            f"others {g.size} of {g[0]:.6g} to {g[-1]:.6g} Hz; give {named('scene')} to simulate "
            "them again"
        )
    notes.append("The presses were simulated again at the other side's frequencies.")
    anew = resimulated(simulated, scene.parts, g)
    return anew.sel(interface=simulated["interface"].values)


def _of_common_readings(
    simulated: xr.Dataset, other: xr.Dataset, notes: list[str]
) -> tuple[xr.Dataset, xr.Dataset]:
    """Both sides at the frequencies of each interface at which both were read."""
    ours, theirs = read_mask(simulated), read_mask(other)
    if np.array_equal(ours, theirs):
        return simulated, other
    common = ours & theirs
    if not common.any():
        raise InputError("no interface was read at the same frequency on both sides")
    notes.append("Readings that only one side has are left out.")
    return restricted(simulated, common), restricted(other, common)


def _check_common_press(simulated: xr.Dataset, other: xr.Dataset) -> None:
    common = set(pixel_of(simulated)) & set(pixel_of(other)) - {0}
    if not common:
        raise InputError("no pixel is pressed in both files")
