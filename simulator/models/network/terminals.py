"""Every contact a terminal of its own: one trained model, and any reading of it.

All contacts together make an N-terminal network. The lift of each terminal is among a model's
coordinates already; that its basis holds what all of them charge takes training that drives all.
Then any two disjoint sets of contacts are a reading, the others floating or tied, without further
training: floating and tied terminals are eliminated in the small system, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypedDict, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...progress import ProgressCallback, silent
from ...scene.contacts import Contact, Interface
from ...scene.scene import Scene
from ...scene.wiring_checks import check_wiring, conductor_groups
from ...sweeps import InputError
from ..heterogeneous.mesh_choice import single_field
from ..reduced.cases import Draw
from ..reduced.greedy import reduce
from ..reduced.indented.draws import spreading
from ..reduced.model import Reduced
from ..reduced.projection import Projection

Model = TypeVar("Model", bound=Projection)


class ReductionOptions(TypedDict):
    """What `reduce` is told of any readings alike."""

    modes: int
    progress: ProgressCallback
    frequency: NDArray[np.float64] | None


def trained(
    scene: Scene,
    rtol: float = 1e-5,
    draw: Draw | None = None,
    *,
    modes: int = 1,
    progress: ProgressCallback = silent,
    frequency: NDArray[np.float64] | None = None,
) -> Reduced:
    """A model of a scene's skin that holds what any terminal charges, read in a `chain`.

    rtol, draw, modes, progress, frequency: as of `reduce`; so is what is raised, and InputError
    where a tension spreads presses.
    """
    require_no_spread(scene)
    more = ReductionOptions(modes=modes, progress=progress, frequency=frequency)
    return reduce(scene, rtol, draw, alike=False, readings=chain(scene), **more)


def require_no_spread(scene: Scene) -> None:
    """Raises InputError where a tension spreads how pixels are pressed."""
    if spreading(scene):
        raise InputError(
            f"{scene.name}: any readings are told of presses by a factor alone; give "
            "`press.capacitance_factor` in place of `press.depth` or `press.force`"
        )


def reduced_for(
    scene: Scene,
    rtol: float = 1e-5,
    draw: Draw | None = None,
    *,
    modes: int = 1,
    alike: bool = True,
    progress: ProgressCallback = silent,
    frequency: NDArray[np.float64] | None = None,
) -> Reduced:
    """A model read in the scene's own ways, trained for all terminals where those are `many`.

    rtol, draw, modes, alike, progress, frequency: as of `reduce`.
    """
    more = ReductionOptions(modes=modes, progress=progress, frequency=frequency)
    if not many(scene, alike):
        return reduce(scene, rtol, draw, alike=alike, **more)
    return read(trained(scene, rtol, draw, **more), scene.interfaces)


def many(scene: Scene, alike: bool = True) -> bool:
    """Whether a scene has more interfaces than a chain has, in two fields, pressed by factors.

    alike: as of `reduce`.
    """
    if spreading(scene) or (alike and single_field(scene) is not None):
        return False
    return len(scene.interfaces) > len(chain(scene))


def read(reduced: Model, readings: Sequence[Interface]) -> Model:
    """The same model read in other ways, without training. reduced: as `trained` gives it.

    Raises InputError for contacts that there are not, shorts, and a model of one field.
    """
    scene = reduced.scene
    if reduced.circuit.fields != 2:
        raise InputError(f"{scene.name}: a model of one field has readings of its own alone")
    try:
        check_wiring(scene.contacts, readings, scene.skin)
    except ValueError as error:
        raise InputError(f"{scene.name}: {error}") from error
    return replace(reduced, circuit=reduced.circuit.read(readings))


def chain(scene: Scene) -> list[Interface]:
    """Readings that drive all terminals, one fewer than those: each shares one with the next.

    Pairs of one terminal of each sheet, those of the same number first; where one sheet has none,
    of the first terminal and each other.
    """
    leaders = _leaders(scene)
    top, bottom = ([c for c in leaders if c.electrode == name] for name in ("top", "bottom"))
    if not (top and bottom):
        first, *others = top or bottom
        return [_between(first, other) for other in others]
    same = [(k, k) for k in range(min(len(top), len(bottom)))]
    next_to = [(min(k, len(top) - 1), min(k + 1, len(bottom) - 1)) for k, _ in same]
    beyond = [(k, len(bottom) - 1) for k in range(len(same), len(top))]
    beyond += [(len(top) - 1, k) for k in range(len(same), len(bottom))]
    pairs = dict.fromkeys([*same, *next_to, *beyond])
    return [_between(top[i], bottom[j]) for i, j in pairs]


def _leaders(scene: Scene) -> list[Contact]:
    """The first contact of each terminal."""
    return [scene.contacts[k] for k in sorted(set(conductor_groups(scene.contacts, scene.skin)))]


def _between(high: Contact, low: Contact) -> Interface:
    return Interface(name=f"{high.name} to {low.name}", high=(high.name,), low=(low.name,))
