"""Twins that rcskin's model did not make, and localizers of them.

A twin is a skin of the three-dimensional solve under a hand: sheets and foam are non-uniform, leads
and meter are drawn, and the skin drifts, as those of `twins`. The surroundings are those of an
effect. Localizers are trained on the model without and with surroundings. What takes time is kept
in a folder.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from joblib import Parallel, delayed
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.foreign_skin import ForeignSkin, Patch
from rcskin.benchmarks.accuracy.static_elements import Grid, body
from rcskin.benchmarks.accuracy.static_solve import Solved, Static, block_of
from rcskin.benchmarks.localization.twin_meters import recorded
from rcskin.benchmarks.localization.twins import (
    CHANGE,
    SEED,
    WHOLE,
    Bench,
    Trial,
    Twin,
    few_of_each,
)
from rcskin.localization.adaptation import adapt_classes
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.model.localizer_file import load as load_model
from rcskin.localization.model.localizer_file import save as save_model
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.model.training import train
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.skin_model import Training, reduced
from rcskin.simulator.measure.skins import DrawnSkin, drawn_skin
from rcskin.simulator.models.parameters import HALF_WAVES, mode_values
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.press.pixels import cell_centres
from rcskin.simulator.press.press import Press, check_press, parse_press
from rcskin.simulator.press.touch import Rectangle
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import read, write

BODY = 5e-3
"""Distance of an earthed plane from the bottom sheet, m: a robot's arm."""
MAX_FINGER = 10e-12
"""Largest capacitance to earth of a fingertip through a thin cover, F."""


@dataclass(frozen=True)
class Effect:
    """The surroundings, the fingers and the foam of a twin.

    earth: True if the three-dimensional solve made the skin and the meter's low terminal is at
    earth's potential; False if the training model made it. finger: smallest and largest capacitance
    to earth of a press, F. body: True if an earthed plane is below. edges: True if the foam has
    fields at the edges of a press. creep: duration of a sweep in which the foam creeps, s; 0 for
    none.
    """

    name: str
    earth: bool = True
    finger: tuple[float, float] = (0.0, 0.0)
    body: bool = False
    edges: bool = False
    creep: float = 0.0


OWN = Effect("none: the model that trains", earth=False)
EARTH = Effect("earth and rim, a rod")
OVER_BODY = Effect("earth, a body 5 mm below, a rod", body=True)
ALL = Effect("all but a body", finger=(0.0, MAX_FINGER), edges=True, creep=0.4)
WITH_BODY = Effect("all", finger=(0.0, MAX_FINGER), edges=True, creep=0.4, body=True)
EFFECTS = (
    OWN,
    EARTH,
    Effect("earth, a finger of 1 pF", finger=(1e-12, 1e-12)),
    Effect("earth, a finger of 2.65 pF", finger=(2.65e-12, 2.65e-12)),
    Effect("earth, a finger of 5.3 pF", finger=(5.3e-12, 5.3e-12)),
    Effect("earth, edges of presses", edges=True),
    Effect("earth, creep, 2 s a sweep", creep=2.0),
    OVER_BODY,
    ALL,
    WITH_BODY,
)


THICKNESS = 4e-3
"""Thickness of the paper's foam, m."""
FINGER = 103
"""Kind of random numbers, in addition to those of `twins`."""
SHARE, TIME = 0.1, 1.0
"""Share of the rise of c that comes by creep, and its time constant, s."""
SAME_FREQUENCY = 1e-3
"""Largest relative difference between a frequency of the scene and that of the meter."""
GRID = (12, 12)
"""Cells of the foam that its cosine modes are fitted to."""


def solved(scene: Scene, folder: Path, grid: Grid) -> dict[bool, Solved]:
    """Static solves of a scene's skin without a body and with one, kept in a folder."""
    files = {there: folder / f"{'body' if there else 'air'}.npz" for there in (False, True)}
    if not all(file.exists() for file in files.values()):
        static = Static(block_of(scene, thickness=THICKNESS, grid=grid))
        static.solved().save(files[False])
        static.solved(below=body(BODY)).save(files[True])
    return {there: Solved.load(file) for there, file in files.items()}


@dataclass(frozen=True)
class Foreign(Twin):
    """A twin with an effect. around: static solve of its scene's skin."""

    effect: Effect = Effect("")
    around: Solved | None = None

    @cached_property
    def drawn(self) -> DrawnSkin:
        """The skin and its leads at the first press."""
        parts = self.scene.parts.on_grid(*GRID)
        return drawn_skin(parts, self.seed, self.number, GRID, len(HALF_WAVES))

    @cached_property
    def foreign(self) -> ForeignSkin:
        """The skin at the first press."""
        assert self.around is not None
        own = self.drawn.variation
        centres = mode_values(
            self.scene.parts.skin, cell_centres(self.scene.parts.skin, GRID), len(HALF_WAVES)
        )
        foam, *_ = np.linalg.lstsq(
            centres.reshape(len(HALF_WAVES), -1).T, own.capacitance.ravel(), rcond=None
        )

        def along(waves: NDArray[np.float64], x: NDArray, y: NDArray) -> NDArray[np.float64]:
            return waves @ mode_values(self.scene.parts.skin, np.stack([x, y]), len(HALF_WAVES))

        return ForeignSkin(
            self.scene,
            self.around,
            top=lambda x, y: 1 / along(own.top, x, y),
            bottom=lambda x, y: 1 / along(own.bottom, x, y),
            foam=lambda x, y: along(foam, x, y),
            edges=self.effect.edges,
        )

    def at(self, interface: str) -> ForeignBench:
        """The twin with a meter at one interface. Raises InputError where there is none."""
        return ForeignBench(self, interface)

    def impedances(self, asked: Press, event: int) -> NDArray[np.complex128]:
        """Z in ohm behind the leads, shape (interface, frequency), at the hand's event-th press.

        With both sheets r times as resistive and all capacitance c times as large, Z at s is r
        times that at r c s.
        """
        known = self._solved.get((asked, event))
        if known is not None:
            return known
        f, (c, r) = self.scene.frequencies, self.drifted(event)
        s = laplace_variable(f, self.drawn.variation.loss)
        hand = self.pressed(asked, event).touches
        patches = [self._patch(touch, event) for touch in hand if isinstance(touch, Rectangle)]
        Z = r * self.foreign.impedance(patches, r * c * s)
        return self._solved.setdefault((asked, event), self.drawn.leads.at_meter(Z, f))

    @cached_property
    def _solved(self) -> dict[tuple[Press, int], NDArray[np.complex128]]:
        """Impedances by press and event: benches at other interfaces read the same presses."""
        return {}

    def _patch(self, touch: Rectangle, event: int) -> Patch:
        random, (least, most) = self._random(FINGER, event), self.effect.finger
        box, finger = touch.box, float(random.uniform(least, most))
        return Patch(*box, factor=1 + (touch.factor - 1) * self._given_way, finger=finger)

    @property
    def _given_way(self) -> NDArray[np.float64] | float:
        """Share of the rise of c, by frequency: frequencies are read one after the other."""
        if not self.effect.creep:
            return 1.0
        count = len(self.scene.frequencies)
        time = self.effect.creep * (np.arange(count) + 1) / count
        return 1 - SHARE * np.exp(-time / TIME)


class ForeignBench(Bench):
    """A foreign twin at one of its interfaces: every press is solved once at all frequencies."""

    def __init__(self, twin: Foreign, interface: str) -> None:
        name = twin.scene.parts.setup.checked_name(interface)
        self._twin, self._number = twin, twin.scene.parts.setup.names.index(name)
        self._event, self._press = 0, Press(())
        self._checked, self._Z = False, None

    def check(self, press: str) -> str:
        """What the hand makes of a press. Raises InputError where it does not fit the scene."""
        scene = self._twin.scene
        asked = check_press(parse_press(press, scene.press.capacitance_factor), scene.parts.skin)
        self._event += self._checked
        self._press, self._checked, self._Z = asked, True, None
        return str(self._twin.pressed(asked, self._event))

    def impedance(self, press: str, frequency: float) -> complex:
        """Z in ohm under the latest checked press, at one of the scene's frequencies in Hz."""
        if self._Z is None:
            self._Z = self._twin.impedances(self._press, self._event)[self._number]
        f = self._twin.scene.frequencies
        nearest = int(np.abs(f - frequency).argmin())
        assert abs(f[nearest] / frequency - 1) < SAME_FREQUENCY, frequency
        return complex(self._Z[nearest])


WAS, TERMS, WIDER = "as it was", "with terms", "drawn wider"
"""Training sweeps: without surroundings; with them; with all distributions wider."""
ALL_FEATURES = (*WHOLE, "lnZ", "phase")
TRAINING_RTOL = 1e-2
"""Certified bound on Rs and Cp of simulated sweeps; most are ten times closer."""
WIDE = 2.0
"""Factor on the spread of the twins' sheets and foam, and on the largest finger."""
SPREADS = {TERMS: (0.2, 0.1), WIDER: (0.5, 0.3)}
"""Spreads of the logarithms of the body's and of the rim's capacitance between skins."""


@dataclass(frozen=True)
class Way:
    """How a localizer is trained.

    name: column of the tables. training: WAS, TERMS or WIDER. estimator, quantities: as of `train`.
    touches: number of touches of each class, on the skin itself, that adapt it.
    """

    name: str
    training: str
    estimator: str = "ksvm-ovo"
    quantities: tuple[str, ...] = CHANGE
    touches: int = 0

    def of(self, folder: Path) -> Path:
        """File of the localizer."""
        return folder / f"localizer-{_file_name(self.name)}.npz"


def believed(scene: Scene, training: str, body: bool) -> Scene:
    """The scene that a localizer is trained on. body: True if there is one below."""
    if training == WAS:
        return scene
    wide, (of_body, of_rim) = (WIDE if training == WIDER else 1.0), SPREADS[training]
    foam, session = scene.skin.foam, scene.dataset.session
    permittivity = foam.unpressed_capacitance_per_area * THICKNESS / VACUUM_PERMITTIVITY
    around: dict[str, object] = {"rim": True, "thickness": True}
    changes: dict[str, object] = {
        "surroundings": around | ({"body": {"distance": BODY}} if body else {}),
        "skin.foam.capacitance_per_area": None,
        "skin.foam.thickness": THICKNESS,
        "skin.foam.relative_permittivity": permittivity,
        "dataset.press.finger": {"low": 0.0, "high": wide * MAX_FINGER},
        "dataset.session.rim": _about_one(of_rim),
    }
    for name in ("sheet_resistance", "sheet_mismatch"):
        changes[f"dataset.session.{name}"] = _about_one(wide * getattr(session, name).spread)
    changes["dataset.session.capacitance.deviation"] = wide * session.capacitance.deviation
    if body:
        changes["dataset.session.body"] = _about_one(of_body)
    return scene.with_(changes)


def _about_one(spread: float) -> dict[str, object]:
    return {"distribution": "lognormal", "median": 1.0, "spread": spread}


def train_missing(
    scene: Scene, training: str, ways: Sequence[Way], target: str, count: int, folder: Path
) -> None:
    """Train the localizers that the folder lacks, all on the same simulated sweeps of a scene."""
    missing = [way for way in ways if not way.of(folder).exists()]
    if not missing:
        return
    sweeps = _simulated(scene, training, count, folder)
    for way in missing:
        model = train(sweeps, target, way.estimator, quantities=way.quantities)
        save_model(way.of(folder), model)


def kept_family(folder: Path, training: str, scene: Scene) -> Reduced:
    """The reduced model of a training scene, trained unless the folder holds it."""
    path = folder / f"family-{_file_name(training)}.npz"
    if not path.exists():
        save(reduced(scene.parts, TRAINING_RTOL), path)
    return load(path)


def after_touches(model: Model, sweeps: xr.Dataset, touches: int) -> tuple[Model, xr.Dataset]:
    """The model adapted by some touches of each class, and the sweeps without these."""
    samples = model.samples(sweeps)
    few = few_of_each(samples, touches)
    used = np.intersect1d(few.rows, np.flatnonzero(sweeps["press"].values != "none"))
    others = np.setdiff1d(np.arange(sweeps.sizes["sweep"]), used)
    return adapt_classes(model, few).model, sweeps.isel(sweep=others)


def loaded(way: Way, folder: Path) -> Model:
    """A localizer that answers sweeps of any skin."""
    return load_model(way.of(folder)).for_any_skin()


def _simulated(scene: Scene, training: str, count: int, folder: Path) -> xr.Dataset:
    """Training sweeps, kept in the folder with the reduced model."""
    family = kept_family(folder, training, scene)
    path = folder / f"{_file_name(training)}-{count}.zarr"
    plan = DatasetPlan(scene.parts, count, SEED, TRAINING_RTOL)
    generate(plan, path, training=Training(lambda *_: family, save, load))
    return read_first(path, count).load()


def _file_name(name: str) -> str:
    return name.replace(", ", "-").replace(" ", "-")


@dataclass(frozen=True)
class Experiment:
    """One question about foreign twins.

    table, title: name of the table, and its title with {skins}. trial: its scene is that of the
    localizers, without surroundings. cases: the localizers of each effect. sweeps: number of
    training sweeps. grid: of the three-dimensional solve.
    """

    table: str
    title: str
    trial: Trial
    cases: Sequence[tuple[Effect, Sequence[Way]]]
    sweeps: int
    grid: Grid = Grid()

    def answers(self, folder: Path, skins: int, processes: int) -> pd.DataFrame:
        """A row for each effect, way and skin."""
        folder.mkdir(parents=True, exist_ok=True)
        around = solved(self.trial.believed, folder, self.grid)
        prepared = Prepared(self, folder, around, self._own(folder), self.models(folder))
        work = (delayed(prepared.of_skin)(number) for number in range(skins))
        found = Parallel(n_jobs=processes, return_as="generator")(work)
        return pd.DataFrame([row for rows in found for row in rows])

    def models(self, folder: Path) -> dict[tuple[str, bool], Model]:
        """Localizers by name, and by whether a body is below."""
        wanted = {(way, effect.body) for effect, ways in self.cases for way in ways}
        return {(way.name, body): self._model(folder, way, body) for way, body in wanted}

    def _own(self, folder: Path) -> Reduced:
        """The model without surroundings, which trains and makes the first twins."""
        return kept_family(_kept(folder, False), WAS, self.trial.believed)

    def _model(self, folder: Path, way: Way, body: bool) -> Model:
        known = body and way.training != WAS
        kept = _kept(folder, known)
        scene = believed(self.trial.believed, way.training, known)
        same = {
            each
            for effect, ways in self.cases
            for each in ways
            if each.training == way.training and (effect.body == body or each.training == WAS)
        }
        ordered = sorted(same, key=lambda each: each.name)
        train_missing(scene, way.training, ordered, self.trial.target, self.sweeps, kept)
        return loaded(way, kept)


def _kept(folder: Path, body: bool) -> Path:
    """Folder of the localizers that know of a body, or of those that do not."""
    kept = folder / ("with-body" if body else "without-body")
    kept.mkdir(exist_ok=True)
    return kept


@dataclass(frozen=True)
class Prepared:
    """An experiment with the surroundings by whether a body is below, and the localizers."""

    experiment: Experiment
    folder: Path
    around: Mapping[bool, Solved]
    family: Reduced
    models: Mapping[tuple[str, bool], Model]

    def of_skin(self, number: int) -> list[dict[str, object]]:
        """Rows of one skin in all its effects."""
        return [row for case in self.experiment.cases for row in self._of(*case, number)]

    def _of(self, effect: Effect, ways: Sequence[Way], number: int) -> list[dict[str, object]]:
        sweeps, rows = self._read(effect, number), []
        for way in ways:
            model, unseen = self.models[way.name, effect.body], sweeps
            if way.touches:
                model, unseen = after_touches(model, sweeps, way.touches)
            score, answered = self.experiment.trial.score(model, unseen)
            case = {"effect": effect.name, "way": way.name, "skin": number}
            rows.append(case | {"score": score, "answered": answered})
        return rows

    def _read(self, effect: Effect, number: int) -> xr.Dataset:
        """Sweeps of a twin, kept in the folder."""
        kind = "".join(c if c.isalnum() else "-" for c in effect.name)
        path = self.folder / f"{kind}-{number}.nc"
        if not path.exists():
            trial = self.experiment.trial
            presses = trial.recording(np.random.default_rng([SEED, number]))
            interfaces = [each.name for each in trial.believed.interfaces]
            sweeps = recorded(self._twin(effect, number), presses, interfaces)
            write(sweeps.assign_attrs(scene=scene_text(trial.believed)), path)
        return read(path)

    def _twin(self, effect: Effect, number: int) -> Twin:
        scene, hand = self.experiment.trial.believed, self.experiment.trial.hand
        if not effect.earth:
            return Twin(scene, self.family, SEED, number, hand)
        around = self.around[effect.body]
        return Foreign(scene, self.family, SEED, number, hand, effect=effect, around=around)
