"""What computations take of a scene: a skin, a setup, a meter and a plan.

`Scene` is what a file says, and checks that its tables agree; these are made from a checked scene
alone, by `Scene.parts`. A computation takes those that it needs.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self, TypeVar

import numpy as np

from ..arrays import Real
from ..sweeps import InputError
from .contacts import Contact, Interface, max_foil_distance
from .design_goals import Design
from .foam import Foam
from .foam_mechanics import Mechanics
from .form import Outline, Shape, Stretch
from .mesh_data import MeshData
from .meter import Readout, Sweep
from .part import Part
from .pixel_grid import Pixels, Pressing
from .randomisation import Randomisation
from .readers import sources_of_others
from .setup import Setup
from .skin import Sheet, SheetsAndFoam
from .surroundings import Surroundings
from .wiring_checks import DrivenByTouch, driven_by_touch

if TYPE_CHECKING:
    from .scene import Scene

SheetOrFoam = TypeVar("SheetOrFoam", Sheet, Foam)
AnySkin = TypeVar("AnySkin", bound=SheetsAndFoam)


def evened(skin: AnySkin) -> AnySkin:
    """Electrically equivalent skin.

    Uniform maps, anisotropy of ratio 1 and bending to a cylinder are always replaced; a stretch is
    replaced if the rest is uniform. A skin without any of them is returned as it is.
    """
    flat = _without_uniform_maps(skin)
    return _stretched(flat) if flat.beyond_uniform == ["skin.stretch"] else flat


def _without_uniform_maps(skin: AnySkin) -> AnySkin:
    """Skin without uniform maps, without anisotropy of ratio 1, and flat if it only bends."""
    changed = {
        "top": _without_uniform_map(_without_unit_anisotropy(skin.top)),
        "bottom": _without_uniform_map(_without_unit_anisotropy(skin.bottom)),
        "foam": _without_uniform_map(skin.foam),
        "shape": None if skin.shape is not None and skin.shape.developable else skin.shape,
    }
    if all(getattr(skin, name) is part for name, part in changed.items()):
        return skin
    return skin.with_parts(**changed)


def _without_unit_anisotropy(sheet: Sheet) -> Sheet:
    if sheet.anisotropy is None or sheet.anisotropy.ratio != 1:
        return sheet
    return sheet.model_copy(update={"anisotropy": None})


def _without_uniform_map(part: SheetOrFoam) -> SheetOrFoam:
    factor = None if part.map is None else part.map.uniform
    if factor is None:
        return part
    return _times(part, factor).model_copy(update={"map": None})


def _times(part: SheetOrFoam, factor: float) -> SheetOrFoam:
    """Part with `factor` times the resistance, or times the capacitance per area."""
    if isinstance(part, Sheet):
        return part.model_copy(update={"sheet_resistance": part.sheet_resistance * factor})
    if part.capacitance_per_area is None and part.mechanics is None:
        assert part.thickness is not None
        return part.model_copy(update={"thickness": part.thickness / factor})
    c = part.unpressed_capacitance_per_area * factor
    return part.model_copy(update={"capacitance_per_area": c, "relative_permittivity": None})


def _stretched(skin: AnySkin) -> AnySkin:
    stretch = skin.stretch
    assert stretch is not None
    along, across = stretch.ratios
    of_sheets, of_foam = ((along * across) ** power for power in stretch.thinning)
    return skin.with_parts(
        length=skin.length * along,
        width=skin.width * across,
        top=_times(skin.top, of_sheets),
        bottom=_times(skin.bottom, of_sheets),
        foam=_thinned(skin.foam, of_foam),
        stretch=None,
    )


def _thinned(foam: Foam, factor: float) -> Foam:
    """Foam with `factor` times the capacitance per area, by its thickness if that is known."""
    thinner = _times(foam, factor)
    if foam.thickness is None:
        return thinner
    return thinner.model_copy(update={"thickness": foam.thickness / factor})


__all__ = ["Meter", "Plan", "Pressing", "SceneParts", "Setup", "Skin"]


@dataclass(frozen=True, eq=False)
class Skin(SheetsAndFoam, Part):
    """A skin at the ambient of its experiment: sheets, foam, contacts, pixels, surroundings.

    name: by which messages refer to it. length, width: before stretching, m. The fields are those
    of a scene's tables of the same names; around: `surroundings`.
    """

    name: str
    length: float
    width: float
    top: Sheet
    bottom: Sheet
    foam: Foam
    contacts: tuple[Contact, ...]
    pixels: Pixels
    outline: Outline | None = None
    mesh: MeshData | None = None
    stretch: Stretch | None = None
    shape: Shape | None = None
    around: Surroundings | None = None

    def with_parts(self, **changed: Any) -> Self:
        """The skin with changed fields."""
        return replace(self, **changed)

    @cached_property
    def electrical(self) -> Skin:
        """Electrically equivalent skin, as uniform and as flat as there is one; see `evened`."""
        return evened(self)

    @property
    def foils(self) -> tuple[Contact, ...]:
        """Contacts of the scene file, without those of earth."""
        if not self.one_conductor:
            return self.contacts
        return tuple(each for each in self.contacts if each.electrode == "top")

    @cached_property
    def for_rods(self) -> Skin:
        """The skin for presses without a finger: equal readings, and one excitation if possible.

        One excitation is enough if only a finger would be charged against earth. The skin itself is
        returned if anything else is.
        """
        if self.around is None or self.around.for_rods is self.around:
            return self
        return replace(self, around=self.around.for_rods)

    def contact(self, name: str) -> Contact:
        """The contact of that name."""
        return next(contact for contact in self.contacts if contact.name == name)

    @property
    def uniform(self) -> bool:
        """True if uniform sheets and foam on an unstretched rectangle are the whole skin."""
        return not (self.beyond_uniform or self.beyond_sheets)

    @property
    def two_terminal(self) -> bool:
        """True if all current that enters the skin leaves it through the meter.

        Otherwise a virtual earth reads only a part of the current, and Z is a transfer impedance,
        to which the laws of passive networks do not apply.
        """
        return self.around is None or self.around.low == "floating"

    @property
    def beyond_sheets(self) -> list[str]:
        """Keys that add more than two sheets with foils on their edges."""
        wide = [f"contact[{k + 1}].width" for k, foil in enumerate(self.contacts) if foil.width]
        return [*(["surroundings"] if self.around else []), *wide]

    def grid(self, cells: int) -> tuple[int, int]:
        """Rows and columns of the grid of cells, so many along each side of a pixel."""
        rows, columns = self.pixels.shape
        return cells * rows, cells * columns

    def on_grid(self, rows: int, columns: int) -> Skin:
        """The skin with a grid of equal pixels, without the limits of `Pixels` on their number."""
        if (rows, columns) == self.pixels.shape and self.pixels.groups is None:
            return self
        return replace(self, pixels=Pixels.model_construct(rows=rows, columns=columns))

    def reach(self, chosen: Iterable[Interface], interfaces: Iterable[Interface]) -> float:
        """Largest distance of a point from its nearest foil driven by the chosen interfaces, m.

        interfaces: of the setup. Sources that are on at the same time drive foils as well.
        """
        chosen, every = tuple(chosen), tuple(interfaces)
        others = [one for each in chosen for one in sources_of_others(each, every)]
        return max_foil_distance(self, self.contacts, [*chosen, *others])

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
        assert self.foam.mechanics is not None
        return self.foam.mechanics

    @property
    def _thickness(self) -> float:
        assert self.foam.thickness is not None
        return self.foam.thickness


@dataclass(frozen=True, eq=False)
class Meter(Part):
    """A meter: its errors, electronics and digits, and how it reads one value after the other.

    readout: see the table of that name. speed, averaging: see `Timing`.
    """

    readout: Readout = Readout()
    speed: str = "MEDIUM"
    averaging: int = 1


@dataclass(frozen=True, eq=False)
class Plan(Part):
    """An experiment: its presses, and what is drawn for data sets.

    press: how pixels are pressed where nothing else is said. repetitions, unpressed, seed: see
    `Experiment`. before, pause: see `Timing`, s. draws: of presses and of sessions.
    """

    press: Pressing = Pressing()
    repetitions: int = 6
    unpressed: bool = True
    seed: int = 1
    before: float = 0.0
    pause: float = 1.0
    draws: Randomisation = Randomisation()
    design: Design | None = None


@dataclass(frozen=True)
class SceneParts:
    """The four parts of a scene.

    whole: the scene that they were made from, for what only its file says.
    """

    skin: Skin
    setup: Setup
    meter: Meter
    plan: Plan
    whole: Scene = field(compare=False, repr=False)

    @cached_property
    def evened(self) -> SceneParts:
        """The parts with the electrically equivalent skin, see `Skin.electrical`."""
        return replace(self, skin=self.skin.electrical)

    @cached_property
    def for_rods(self) -> SceneParts:
        """The parts with `Skin.for_rods`; themselves if pixels are pressed by a finger."""
        return self if self.plan.press.finger else replace(self, skin=self.skin.for_rods)

    def read(self, setup: Setup) -> SceneParts:
        """The parts with another setup."""
        return replace(self, setup=setup)

    @property
    def driven_by_touch(self) -> list[DrivenByTouch]:
        """Contacts that float at an interface but touch driven ones."""
        return driven_by_touch(self.skin.contacts, self.setup.interfaces, self.skin)

    def pressed_by(self, press: Pressing) -> SceneParts:
        """The parts with another press of pixels."""
        return replace(self, plan=replace(self.plan, press=press))

    def on_grid(self, rows: int, columns: int) -> SceneParts:
        """The parts with a grid of equal pixels, see `Skin.on_grid`."""
        return replace(self, skin=self.skin.on_grid(rows, columns))

    def divided(self, cells: int) -> SceneParts:
        """The parts with each pixel divided into cells along each side; themselves for 1."""
        return self if cells == 1 else self.on_grid(*self.skin.grid(cells))

    @cached_property
    def scene(self) -> Scene:
        """The scene with these parts, which are not checked again."""
        skin, setup = self.skin, self.setup
        table = {name: getattr(skin, name) for name in type(self.whole.skin).model_fields}
        changed = {
            "name": skin.name,
            "skin": self.whole.skin.model_copy(update=table),
            "contacts": skin.contacts,
            "pixels": skin.pixels,
            "surroundings": skin.around,
            "interfaces": setup.interfaces,
            "leads": setup.leads,
            "sweep": Sweep(frequencies=tuple(setup.frequency.tolist())),
            "press": self.plan.press,
            "dataset": self.plan.draws,
            "design": self.plan.design,
            "readout": self.meter.readout,
        }
        return self.whole.model_copy(update=changed)

    @cached_property
    def text(self) -> str:
        """The scene as the text of its file, which results and trained models keep."""
        from .scene_files import scene_text

        return scene_text(self.scene)

    @classmethod
    def of(cls, scene: Scene) -> SceneParts:
        """SceneParts of a checked scene."""
        skin, experiment = scene.skin, scene.experiment
        timed = experiment.timed
        return cls(
            Skin(
                name=scene.name,
                length=skin.length,
                width=skin.width,
                top=skin.top,
                bottom=skin.bottom,
                foam=skin.foam,
                contacts=scene.contacts,
                pixels=scene.pixels,
                outline=skin.outline,
                mesh=skin.mesh,
                stretch=skin.stretch,
                shape=skin.shape,
                around=scene.surroundings,
            ),
            Setup(scene.interfaces, np.array(scene.sweep.frequencies), scene.leads),
            Meter(scene.readout, timed.speed, timed.averaging),
            Plan(
                press=scene.press,
                repetitions=experiment.repetitions,
                unpressed=experiment.unpressed,
                seed=experiment.seed,
                before=timed.before,
                pause=timed.pause,
                draws=scene.dataset,
                design=scene.design,
            ),
            scene,
        )
