"""One trained model with every contact as a terminal of its own, for any interfaces.

All contacts together make an N-terminal network. The lift of each terminal is among a model's
coordinates already. Its basis represents the charges of all terminals if its training excites all.
Then any two disjoint sets of contacts are an interface, the others floating or tied, without
further training: floating and tied terminals are eliminated in the small system, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypedDict, TypeVar

from ..arrays import Real
from ..progress import ProgressCallback, silent
from ..scene.contacts import Contact, Interface
from ..scene.parts import Pressing, SceneParts, Setup, Skin
from ..scene.wiring_checks import check_wiring, conductor_groups
from ..sweeps import InputError
from .heterogeneous.elements_model import single_field
from .reduced.cases import Draw
from .reduced.greedy import reduce
from .reduced.projection import Projection
from .reduced.reduced_model import Reduced
from .reduced.touches import spreading

Model = TypeVar("Model", bound=Projection)


class ReductionOptions(TypedDict):
    """Options of `reduce` that do not depend on the interfaces."""

    modes: int
    progress: ProgressCallback
    frequency: Real | None


def trained(
    parts: SceneParts,
    rtol: float = 1e-5,
    draw: Draw | None = None,
    *,
    modes: int = 1,
    progress: ProgressCallback = silent,
    frequency: Real | None = None,
) -> Reduced:
    """Reduced model of a scene's skin that represents all terminals, with the interfaces of a
    `chain`.

    rtol, draw, modes, progress, frequency: see `reduce`, which also lists the errors raised.
    No tension may spread presses.
    """
    more = ReductionOptions(modes=modes, progress=progress, frequency=frequency)
    return reduce(parts, rtol, draw, same_sheets=False, readings=chain(parts.skin), **more)


def reduced_for(
    parts: SceneParts,
    rtol: float = 1e-5,
    draw: Draw | None = None,
    *,
    modes: int = 1,
    same_sheets: bool = True,
    progress: ProgressCallback = silent,
    frequency: Real | None = None,
) -> Reduced:
    """Model with the scene's own interfaces, trained for all terminals if it `needs_all_terminals`.

    rtol, draw, modes, same_sheets, progress, frequency: see `reduce`.
    """
    more = ReductionOptions(modes=modes, progress=progress, frequency=frequency)
    if not needs_all_terminals(parts.skin, parts.setup, parts.plan.press, same_sheets):
        return reduce(parts, rtol, draw, same_sheets=same_sheets, **more)
    return read(trained(parts, rtol, draw, **more), parts.setup.interfaces)


def needs_all_terminals(
    skin: Skin, setup: Setup, pressing: Pressing, same_sheets: bool = True
) -> bool:
    """True if a scene of two fields, pressed by factors, has more interfaces than a chain.

    same_sheets: see `reduce`.
    """
    if spreading(skin, pressing) or (same_sheets and single_field(skin, setup) is not None):
        return False
    return len(setup.solved) > len(chain(skin))


def read(reduced: Model, readings: Sequence[Interface]) -> Model:
    """Same model with other interfaces, without training. reduced: from `trained`.

    Raises InputError for unknown contacts, shorts, and a model of one field.
    """
    skin = reduced.parts.skin
    if reduced.circuit.fields != 2:
        raise InputError(f"{skin.name}: a model of one field has no other interfaces than its own")
    try:
        check_wiring(skin.contacts, readings, skin)
    except ValueError as error:
        raise InputError(f"{skin.name}: {error}") from error
    return replace(reduced, circuit=reduced.circuit.read(readings))


def chain(skin: Skin) -> list[Interface]:
    """Interfaces that excite all terminals, one fewer than those: each shares one with the next.

    Pairs of one terminal of each sheet, those of the same number first; if one sheet has none,
    pairs of the first terminal and each other.
    """
    leaders = _leaders(skin)
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


def _leaders(skin: Skin) -> list[Contact]:
    """First contact of each terminal."""
    return [skin.contacts[k] for k in sorted(set(conductor_groups(skin.contacts, skin)))]


def _between(high: Contact, low: Contact) -> Interface:
    return Interface(name=f"{high.name} to {low.name}", high=(high.name,), low=(low.name,))
