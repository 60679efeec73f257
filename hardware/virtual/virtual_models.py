"""Virtual meters by the name of the model that each imitates."""

from __future__ import annotations

from collections.abc import Callable

from ...simulator.sweeps import InputError
from .hioki import VirtualHioki
from .instrument import Instrument
from .keysight_analyser import VirtualE4990A
from .keysight_lcr import Virtual4284A, VirtualE4980A, VirtualE4980AL

VIRTUAL_MODELS: dict[str, Callable[..., Instrument]] = {
    "IM3523": VirtualHioki,
    "E4980A": VirtualE4980A,
    "E4980AL": VirtualE4980AL,
    "4284A": Virtual4284A,
    "E4990A": VirtualE4990A,
}
"""Class of each model."""


def virtual_model(name: str) -> Callable[..., Instrument]:
    """Class of a model by its name, in any case. Raises InputError for another one."""
    try:
        return VIRTUAL_MODELS[name.upper()]
    except KeyError:
        known = ", ".join(VIRTUAL_MODELS)
        raise InputError(f"`model` must be one of {known}, got {name!r}") from None
