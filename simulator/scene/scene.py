"""The model of a scene: skin, contacts, interfaces, surroundings, pixels and measurement."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from functools import cached_property
from importlib import import_module
from typing import Annotated, Any, Self

import numpy as np
from pydantic import (
    AfterValidator,
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
    model_validator,
)

from ..sweeps import InputError
from .contacts import MAX_CONTACTS, MAX_INTERFACES, Contact, Interface, check_frequencies
from .design_goals import Design
from .foam import in_ambient
from .keys import put
from .meter import AnyReadout, Experiment, Leads, Readout, Sweep
from .meter_tables import check_readout
from .multisine import scene_reader
from .parts import SceneParts
from .pixel_grid import Pixels, Pressing, with_drawn_factor, with_factor
from .randomisation import Randomisation
from .readings_short_form import Readings, with_interfaces
from .skin import Name, SkinTable
from .surroundings import AnySurroundings, check_finger
from .validation import Table, one_line
from .wiring_checks import check_wiring, with_earth, without_earth

BOTH = {
    "pixels": ("pixels.rows", "pixels.columns"),
    "skin.sheet_resistance": ("skin.top.sheet_resistance", "skin.bottom.sheet_resistance"),
}

IN_WORDS, IN_NOTEBOOKS = "..describe.facts", "..describe.notebook_scene"
"""Modules that show a scene; they are imported then, because their package lies above."""


def _spent(readings: object) -> None:
    """Removes the readings, which are already converted to interfaces."""


class Scene(Table):
    """Everything that determines a simulated measurement.

    name: by which results and messages refer to the scene. description: free text for readers.
    plausible: false states that unusual numbers are intended; no command then warns of them.
    """

    name: Name
    description: str = ""
    plausible: bool | None = None
    skin: SkinTable
    contacts: Annotated[
        tuple[Contact, ...], Field(alias="contact", min_length=1, max_length=MAX_CONTACTS)
    ]
    interfaces: Annotated[
        tuple[Interface, ...], Field(alias="interface", min_length=1, max_length=MAX_INTERFACES)
    ]
    readings: Annotated[Readings | None, AfterValidator(_spent), Field(exclude=True)] = None
    surroundings: AnySurroundings | None = None
    pixels: Pixels
    press: Pressing = Pressing()
    leads: Leads = Leads()
    sweep: Sweep
    readout: AnyReadout = Readout()
    experiment: Experiment = Experiment()
    dataset: Randomisation = Randomisation()
    design: Design | None = None

    @model_validator(mode="before")
    @classmethod
    def _readings_are_interfaces(cls, given: Any) -> Any:
        return with_interfaces(given) if isinstance(given, dict) else given

    @model_validator(mode="before")
    @classmethod
    def _earth_has_contacts(cls, given: Any) -> Any:
        return with_earth(given) if isinstance(given, dict) else given

    @model_serializer(mode="wrap")
    def _earth_as_given(self, everything: SerializerFunctionWrapHandler) -> dict[str, object]:
        kept = everything(self)
        return without_earth(kept) if self.skin.one_conductor else kept

    def __str__(self) -> str:
        """The scene in words, as `rcskin describe` prints them."""
        return import_module(IN_WORDS, __package__).described(self)

    def _repr_html_(self) -> str:
        return import_module(IN_NOTEBOOKS, __package__).scene_display(self)

    @property
    def title(self) -> str:
        """The name with the description, if there is one."""
        return f"{self.name}: {self.description}" if self.description else self.name

    @property
    def frequencies(self) -> np.ndarray:
        """Hz, ascending, shape (frequency,)."""
        return np.array(self.sweep.frequencies)

    @cached_property
    def parts(self) -> SceneParts:
        """The skin, setup, meter and plan, which computations take."""
        return SceneParts.of(self)

    def __copy__(self) -> Self:
        """A copy, which makes its own parts: copies are given other tables."""
        copied = super().__copy__()
        vars(copied).pop("parts", None)
        return copied

    def with_(self, changes: Mapping[str, object]) -> Scene:
        """The scene with changed keys of its file, such as {"skin.top.sheet_resistance": 35e3}.

        Items of lists are named by number from 1 or by name: "contact.left-top.resistance".
        "pixels" changes both counts, "skin.sheet_resistance" both sheets; None removes a key.
        changes: new values by key. Raises InputError for a key or value that the scene does not
        take.
        """
        table = self.model_dump(mode="json", by_alias=True, exclude_none=True)
        for name, value in changes.items():
            for key in (name,) if isinstance(value, Mapping) else BOTH.get(name, (name,)):
                put(table, key, deepcopy(value))
        try:
            return Scene.model_validate(table)
        except ValidationError as error:
            raise InputError(f"{self.name}: {one_line(error, Scene)}") from error

    @model_validator(mode="after")
    def _tones_on_the_grid_of_a_frame(self) -> Self:
        reader = scene_reader(self.interfaces, self.readout.multisine, self.sweep.frequencies)
        if reader is not None:
            tones = tuple(reader.tones.tolist())
            changed = {
                "sweep": self.sweep.model_copy(update={"frequencies": tones}),
                "readout": self.readout.model_copy(update={"multisine": reader}),
            }
            return self.model_copy(update=changed)
        return self

    @model_validator(mode="after")
    def _mechanics_for_depth_and_force(self) -> Self:
        if not self.press.by_factor and self.skin.foam.mechanics is None:
            raise ValueError("`press` depth and force need the table skin.foam.mechanics")
        return self

    @model_validator(mode="after")
    def _in_its_ambient(self) -> Self:
        skin = in_ambient(self.skin, self.experiment)
        self.dataset.session.check_ambient(skin.foam)
        return self if skin is self.skin else self.model_copy(update={"skin": skin})

    @model_validator(mode="after")
    def _touches_add_capacitance(self) -> Self:
        drawn = self.dataset.press
        if self.press.adds is None:
            if drawn.capacitance is not None:
                raise ValueError("`dataset.press.capacitance` needs `press.adds`")
            return self
        press = with_factor(self.press, self.skin, self.pixels)
        drawn = with_drawn_factor(drawn, press, self.skin, self.pixels)
        dataset = self.dataset.model_copy(update={"press": drawn})
        return self.model_copy(update={"press": press, "dataset": dataset})

    @model_validator(mode="after")
    def _fingers_have_earth(self) -> Self:
        check_finger(self.press.finger, self.surroundings)
        return self

    @model_validator(mode="after")
    def _contacts_and_interfaces_agree(self) -> Self:
        check_wiring(self.contacts, self.interfaces, self.skin)
        check_frequencies(self.interfaces, self.sweep.frequencies)
        check_readout(self.interfaces, self.readout)
        self.skin.check_depth(max(self.sweep.frequencies))
        return self
