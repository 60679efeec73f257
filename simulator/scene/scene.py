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

from ..arrays import Mask, Real
from ..sweeps import InputError
from .design_goals import Design
from .draws.draw_distributions import AnyDistribution
from .draws.randomisation import Randomisation
from .foam.foam_in_time import in_ambient
from .foam.foam_mechanics import Mechanics
from .keys.changing import put
from .multisine.scene_tones import scene_reader
from .parts import SceneParts
from .pixel_grid import Pixels, Pressing
from .readings.contacts import (
    MAX_CONTACTS,
    MAX_INTERFACES,
    Contact,
    Interface,
    check_frequencies,
    max_foil_distance,
    taken,
)
from .readings.one_conductor import with_earth, without_earth
from .readings.readers import sources_of_others
from .readings.readings_short_form import Readings, with_interfaces
from .readings.wiring_checks import DrivenByTouch, check_wiring, driven_by_touch
from .readout.converter import check_readout
from .readout.meter import AnyReadout, Experiment, Leads, Readout, Sweep
from .skin import Name, SkinTable
from .surroundings import AnySurroundings, check_finger
from .touch_capacitance import with_drawn_factor, with_factor
from .validation import Table, one_line

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

    @property
    def taken(self) -> Mask | None:
        """Mask of the readings, or None if all are taken, see `contacts.taken`."""
        return taken(self.interfaces, self.frequencies)

    @property
    def foils(self) -> tuple[Contact, ...]:
        """Contacts of the scene file, without those of earth."""
        if not self.skin.one_conductor:
            return self.contacts
        return tuple(each for each in self.contacts if each.electrode == "top")

    @cached_property
    def parts(self) -> SceneParts:
        """The skin, setup, meter and plan, which computations take."""
        return SceneParts.of(self)

    def __copy__(self) -> Self:
        """A copy, which makes its own parts: copies are given other tables."""
        copied = super().__copy__()
        vars(copied).pop("parts", None)
        return copied

    @property
    def uniform(self) -> bool:
        """True if uniform sheets and foam on an unstretched rectangle are the whole scene."""
        return not self.beyond_uniform

    @property
    def beyond_uniform(self) -> list[str]:
        """Keys that make the scene more than `uniform` allows."""
        return [*self.skin.beyond_uniform, *self.beyond_sheets]

    @property
    def beyond_sheets(self) -> list[str]:
        """Keys that add more than two sheets with foils on their edges."""
        wide = [f"contact[{k + 1}].width" for k, foil in enumerate(self.contacts) if foil.width]
        return [*(["surroundings"] if self.surroundings else []), *wide]

    @property
    def two_terminal(self) -> bool:
        """True if all current that enters the skin leaves it through the meter.

        Otherwise a virtual earth reads only a part of the current, and Z is a transfer impedance,
        to which the laws of passive networks do not apply.
        """
        return self.surroundings is None or self.surroundings.low == "floating"

    @property
    def for_rods(self) -> Scene:
        """The scene for presses without a finger: equal readings, and one excitation if possible.

        One excitation is enough if only a finger would be charged against earth. The scene itself
        is returned if other parts are charged against earth, and if `press` has a finger.
        """
        around = self.surroundings
        if around is None or self.press.finger or around.for_rods is around:
            return self
        return self.model_copy(update={"surroundings": around.for_rods})

    def require_sheets_alone(self, what: str) -> None:
        """Raises InputError naming a key of `beyond_sheets`, which `what` does not support."""
        for key in self.beyond_sheets:
            raise InputError(f"{self.name}: {what} cannot take `{key}`; leave it out here")

    @property
    def pressed_factor(self) -> float:
        """Capacitance factor of a pixel under the press of the scene.

        Raises InputError as `factor_at` does.
        """
        press = self.press
        return press.capacitance_factor if press.by_factor else self.factor_at(press.depth)

    def factor_at(self, depth: float | None) -> float:
        """Capacitance factor under an applicator at a depth in m; None is for `press.force`.

        Raises InputError for a depth beyond the foam's range, and for None, because the depth of a
        force differs between pixels.
        """
        if depth is None:
            raise InputError(
                f"{self.name}: `press.force` presses pixels to different depths; give "
                "`press.depth` here"
            )
        deepest = self._mechanics.elastic.greatest_strain * self._thickness
        if depth > deepest:
            raise InputError(
                f"{self.name}: `press.depth` must be <= {deepest:.4g} m, where foam cells are "
                f"closed, got {depth:g}"
            )
        return float(self.pressed_factors(np.array(depth)))

    def pressed_factors(self, depth: Real) -> Real:
        """Capacitance factors under applicators at depths in m within the foam's range."""
        return self._mechanics.factor(depth / self._thickness)

    def pressed_depths(self, factor: Real) -> Real:
        """Depths of applicators at capacitance factors, m; 0 for factors up to 1."""
        return self._mechanics.strain_at(factor) * self._thickness

    def pressed_depth(self, factor: float) -> float:
        """Depth of an applicator at a capacitance factor, m.

        Raises InputError for a factor below 1 or beyond the foam's range.
        """
        highest = self.max_factor
        if not 1 <= factor <= highest:
            raise InputError(
                f"{self.name}: c under an applicator must be from 1 to {highest:.4g} times the "
                f"unpressed one, got {factor:g}"
            )
        return float(self.pressed_depths(np.array(factor)))

    @property
    def max_factor(self) -> float:
        """Capacitance factor under an applicator at which the foam's cells are closed."""
        return float(self._mechanics.factor(np.array(self._mechanics.elastic.greatest_strain)))

    @property
    def _mechanics(self) -> Mechanics:
        assert self.skin.foam.mechanics is not None
        return self.skin.foam.mechanics

    @property
    def _thickness(self) -> float:
        assert self.skin.foam.thickness is not None
        return self.skin.foam.thickness

    @property
    def drawn_factor(self) -> AnyDistribution:
        """Distribution of the capacitance factor of drawn presses."""
        return self.dataset.press.factor_within(self.skin.foam)

    def reach(self, *interfaces: Interface) -> float:
        """Largest distance of a point of the skin from its nearest foil driven by interfaces, m.

        By default all interfaces of the scene count. Sources that are on at the same time drive
        foils as well.
        """
        chosen = interfaces or self.interfaces
        others = [one for each in chosen for one in sources_of_others(each, self.interfaces)]
        return max_foil_distance(self.skin, self.contacts, [*chosen, *others])

    @property
    def driven_by_touch(self) -> list[DrivenByTouch]:
        """Contacts that float at an interface but touch driven ones."""
        return driven_by_touch(self.contacts, self.interfaces, self.skin)

    def on_grid(self, rows: int, columns: int) -> Scene:
        """The scene with a grid of equal pixels, without the limits of `Pixels` on their number."""
        pixels = Pixels.model_construct(rows=rows, columns=columns)
        return self.model_copy(update={"pixels": pixels})

    def divided(self, cells: int) -> Scene:
        """The scene with each pixel divided into cells along each side; the scene itself for 1."""
        rows, columns = self.pixels.shape
        return self if cells == 1 else self.on_grid(cells * rows, cells * columns)

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

    def contact(self, name: str) -> Contact:
        """The contact of that name."""
        return next(contact for contact in self.contacts if contact.name == name)

    @model_validator(mode="after")
    def _tones_on_the_grid_of_a_frame(self) -> Self:
        reader = scene_reader(self.interfaces, self.readout.multisine, self.sweep.frequencies)
        if reader is not None:
            sweep, readout = (
                self.sweep.model_copy(update={"frequencies": tuple(reader.tones.tolist())}),
                self.readout.model_copy(update={"multisine": reader}),
            )
            object.__setattr__(self, "sweep", sweep)
            object.__setattr__(self, "readout", readout)
        return self

    @model_validator(mode="after")
    def _mechanics_for_depth_and_force(self) -> Self:
        if not self.press.by_factor and self.skin.foam.mechanics is None:
            raise ValueError("`press` depth and force need the table skin.foam.mechanics")
        return self

    @model_validator(mode="after")
    def _in_its_ambient(self) -> Self:
        object.__setattr__(self, "skin", in_ambient(self.skin, self.experiment))
        self.dataset.session.check_ambient(self.skin.foam)
        return self

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
        object.__setattr__(self, "press", press)
        object.__setattr__(self, "dataset", dataset)
        return self

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
