"""How far foam gives way: errors for depths and forces beyond."""

from __future__ import annotations

from collections.abc import Iterable

from simulator.foam_properties import Mechanics
from simulator.press import Depth, Press
from simulator.sweeps import InputError


def check_depths(press: Press, mechanics: Mechanics, thickness: float) -> None:
    """Raises InputError where a given depth is beyond what the foam can be compressed to."""
    for touch in press.indented:
        if isinstance(touch.by, Depth) and touch.by.value > greatest(mechanics, thickness):
            raise InputError(
                f"press {press}: depth must be {_range(mechanics, thickness)}, got {touch.by}"
            )


def check_reached(
    press: Press, depth: Iterable[float], mechanics: Mechanics, thickness: float
) -> None:
    """Raises InputError where a given force would take a deeper press than that."""
    for touch, reached in zip(press.indented, depth, strict=True):
        if not reached <= greatest(mechanics, thickness):
            raise InputError(
                f"press {press}: force must leave the depth {_range(mechanics, thickness)}, "
                f"got {touch.by}"
            )


def greatest(mechanics: Mechanics, thickness: float) -> float:
    """The greatest depth, m."""
    return mechanics.elastic.greatest_strain * thickness


def _range(mechanics: Mechanics, thickness: float) -> str:
    strain = mechanics.elastic.greatest_strain
    return (
        f"<= {strain * thickness:.4g} m, where foam of {thickness:g} m is compressed by "
        f"{strain:.3g} and its cells are closed"
    )
