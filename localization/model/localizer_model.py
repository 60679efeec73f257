"""A trained localizer: it predicts the press of a sweep, or answers "cannot tell"."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray

from ...simulator.report.findings import DataTable, Findings, Result
from ...simulator.scene.scene_files import carried_scene
from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import kind_of
from ...simulator.sweeps.same_skin import check_same_skin, same_frequencies
from ..inputs.baselines import check_baselines, finite_sweeps
from ..inputs.features import (
    NAMES,
    QUANTITIES,
    at_interfaces,
    available_features,
    baseline_changes,
    names_beside,
    taken_rows,
)
from ..inputs.samples import LocalizationProblem, Samples, fingerprints_of, samples_of
from ..inversion.adapted import Adapted
from ..inversion.region import Region
from ..inversion.regions import regions_of
from ..parts.plain import Plain, Sizes, require, transient
from ..parts.predictor import Predictor
from ..trust.answers import CANNOT_TELL, NOTHING_PRESSED, ONE_TOUCH, Answers
from ..trust.diagnosis import Diagnosis, diagnosis_features
from ..trust.fitted import Classifier, Regressor

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.arrays import Real
    from ...simulator.scene.scene import Scene


def check_compatible(
    trained: LocalizationProblem, sweeps: xr.Dataset, rest: xr.Dataset | None, *, any_skin: bool
) -> None:
    """Raises InputError if the sweeps or baseline sweeps do not match the training.

    trained: what a model predicts, and from what. any_skin: the skin may be another one.
    """
    kind = kind_of(sweeps.variables)
    lacking = set(trained.quantities) - set(NAMES[kind.name].all)
    if lacking:
        raise InputError(
            f"the model was trained on the features {', '.join(trained.quantities)}, and the "
            f"sweeps hold the {kind.name}, which has no {min(lacking)}"
        )
    for part in (sweeps,) if rest is None else (sweeps, rest):
        own = str(part.attrs.get("scene", ""))
        if own != trained.scene and not any_skin:
            check_same_skin(trained.scene, own, "the model", "trained")
    given_names = [str(name) for name in sweeps["interface"].values]
    if not set(trained.interfaces) <= set(given_names):
        raise InputError(
            f"the model was trained on interfaces {', '.join(trained.interfaces)}, "
            f"the sweeps have {', '.join(given_names)}"
        )
    if taken_rows(at_interfaces(sweeps, trained.interfaces)) != trained.taken:
        raise InputError(
            "the model was trained on interfaces read at other `frequencies` of their own "
            "than the sweeps"
        )
    known, given = np.array(trained.frequencies), sweeps["frequency"].values
    if given.size != known.size:
        raise InputError(
            f"the model was trained on {known.size} frequencies, the sweeps have {given.size}"
        )
    other = np.flatnonzero(~same_frequencies(given, known))
    if other.size:
        raise InputError(
            f"the model was trained at {known[other[0]]:.12g} Hz, "
            f"the sweeps have {given[other[0]]:.12g} Hz in its place"
        )


SOFTWARE = ("rcskin", "scikit-learn")
"""Packages whose versions at the training a model stores."""


def current_versions() -> dict[str, str]:
    """Installed versions of SOFTWARE."""
    return {name: version(name) for name in SOFTWARE}


@dataclass(frozen=True, repr=False)
class Model(Plain, Result):
    """A trained localizer and a description of its training, to check sweeps against."""

    learned: Classifier | Regressor
    estimator: str
    """Name of the estimator."""
    problem: LocalizationProblem
    certain: Annotated[float, ">0"] | None
    """Required accuracy of answers; None if every sweep is answered."""
    validation: str
    """Text on how sweeps were held out to calibrate probabilities and deviations."""
    versions: Mapping[str, str]
    """Versions of SOFTWARE at the training."""
    trained_on: Annotated[int, ">=0"]
    """Number of sweeps."""
    left_out: str
    """Description of the sweeps that were left out."""
    fingerprints: Annotated[NDArray[np.uint64], "sweeps int"] = field(compare=False)
    """Fingerprints of the sweeps of training and adaptation, see `fingerprints_of`."""
    gate: Model | None = None
    """Model of the number of touches, for positions; None if all training sweeps had one touch."""
    diagnosis: Diagnosis | None = None
    """Names faults that sweeps without an answer resemble; None if the training had none."""
    adapted: bool = False
    """True if it was adapted by touches of a skin."""
    any_skin: bool = transient(default=False)
    """True if sweeps of another skin are accepted."""
    source: str = transient(default="the model")
    """Name of the model in errors: its file."""

    def _check(self, sizes: Sizes) -> None:
        learned, problem, gate = self.learned, self.problem, self.gate
        own = isinstance(learned, Regressor) == problem.continuous
        require(own, "learned", f"must be of `problem.target` {problem.target}")
        names, readings = problem.quantities, problem.readings
        require(names and set(names) <= {*QUANTITIES}, "problem.quantities", "must be of features")
        features = len(names) * readings
        require(problem.features == features, "problem.features", f"must be {features}")
        given = learned.predictor.features
        require(given == features, "learned.predictor", f"takes {given} features of {features}")
        require(gate is None or problem.continuous, "gate", "is for positions")
        fits = gate is None or (gate.target == "touches" and gate.problem.readings == readings)
        require(fits, "gate", "must count touches from the same readings")
        each = len(names_beside(names).relative)
        possible = [readings * k for k in range(1, each + 1)]
        guards = learned.guards and learned.guards.changes
        fits = not guards or guards.features in possible
        require(fits, "learned.guards.changes", "must be of the changes of these readings")
        kinds = {} if self.diagnosis is None else self.diagnosis.guards
        fits = all(guard.features in possible for guard in kinds.values())
        require(fits, "diagnosis", "must be of these readings")

    @property
    def report(self) -> Findings:
        """What the model was trained on, and how well it answers sweeps held out."""
        from .held_out_chart import held_out_chart

        header = "target", "estimator", "features", "frequencies", "trained on", "held out"
        known = f"{self.trained_on} sweeps", self.learned.outcome
        features = ", ".join(self.quantities)
        row = (self.target, self.estimator, features, len(self.frequencies), *known)
        return Findings(
            "Model", [DataTable("model", header, [row])], small=lambda: held_out_chart(self)
        )

    @property
    def version_difference(self) -> str:
        """The version of rcskin that trained the model, if it is not this one; else empty."""
        then, here = self.versions.get("rcskin", "none"), version("rcskin")
        return "" if then == here else f"rcskin {then} (here {here})"

    def for_any_skin(self) -> Model:
        """A copy of the model that also accepts sweeps of another skin."""
        return replace(self, any_skin=True, gate=self.gate and self.gate.for_any_skin())

    def in_background(self) -> Model:
        """A copy that computes tables of new skins in the background, see `SkinCache`."""
        if not isinstance(self.predictor, Adapted):
            return self
        return replace(
            self, learned=replace(self.learned, predictor=self.predictor.in_background())
        )

    def with_fingerprints(self, sweeps: xr.Dataset) -> Model:
        """A copy of the model with the fingerprints of further sweeps."""
        further = fingerprints_of(sweeps)
        return replace(self, fingerprints=np.concatenate([self.fingerprints, further]))

    @property
    def predictor(self) -> Predictor:
        """What predicts from features."""
        return self.learned.predictor

    @property
    def target(self) -> str:
        """The predicted target, one of TARGETS."""
        return self.problem.target

    @property
    def quantities(self) -> tuple[str, ...]:
        """Quantities of the features."""
        return self.problem.quantities

    @property
    def interfaces(self) -> tuple[str, ...]:
        """Interfaces that are used, in order."""
        return self.problem.interfaces

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Hz, ascending."""
        return self.problem.frequencies

    @property
    def own_frequencies(self) -> dict[str, tuple[float, ...]]:
        """Frequencies by interface, Hz, ascending; empty if all interfaces have the same."""
        return {
            name: tuple(f for f, read in zip(self.frequencies, row, strict=True) if read)
            for name, row in zip(self.interfaces, self.problem.taken, strict=False)
        }

    @property
    def scene(self) -> Scene | None:
        """The scene of the training, None if unknown. Raises as `carried_scene`."""
        return carried_scene(self.problem.scene, self.source)

    @property
    def known_scene(self) -> Scene:
        """The scene of the training. Raises InputError as `scene`, and if it is unknown."""
        if self.scene is None:
            reason = "was trained on sweeps without a scene, which is needed here"
            raise InputError(f"{self.source}: {reason}")
        return self.scene

    @property
    def classes(self) -> tuple[int | str, ...]:
        """Classes of a classifier; empty for positions."""
        return tuple(self.learned.classes.tolist()) if isinstance(self.learned, Classifier) else ()

    @property
    def knows_unpressed(self) -> bool:
        """True if "nothing pressed" is a possible answer: the training had baseline sweeps."""
        known = self.gate.classes if self.gate else self.classes
        return any(str(label) in NOTHING_PRESSED for label in known)

    def features(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> Real:
        """Features of the sweeps, shape (sweep, feature).

        Raises InputError as `usable_features`, and if a sweep has no baseline sweep before it.
        """
        X, rows = self.usable_features(sweeps, rest)
        check_baselines(sweeps, rows)
        return X

    def usable_features(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None = None
    ) -> tuple[Real, NDArray[np.intp]]:
        """Features of the sweeps that have them, (row, feature), and the numbers of these sweeps.

        rest: baseline sweeps, if the model needs them and they are not among `sweeps`. Raises
        InputError if the scene of these or of the sweeps is another skin's, if frequencies differ
        from those of the training, if an interface is missing, or if there is no baseline sweep at
        all.
        """
        check_compatible(self.problem, sweeps, rest, any_skin=self.any_skin)
        X, rows = available_features(sweeps, self.quantities, interfaces=self.interfaces, rest=rest)
        if not rows.size and finite_sweeps(at_interfaces(sweeps, self.interfaces)).any():
            check_baselines(sweeps, rows)
        return X, rows

    @property
    def guards_use_changes(self) -> bool:
        """True if the guards use changes from the baseline although the model does not."""
        return self.learned.guards is not None and self.learned.guards.changes is not None

    def guard_changes(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None, rows: NDArray[np.intp]
    ) -> Real | None:
        """Changes from the baseline for the guards, (row, feature); None if they do not use them.

        NaN for rows without a baseline: there the guards are not applied.
        """
        guards = self.learned.guards and self.learned.guards.changes
        if guards is None:
            return None
        changes = baseline_changes(sweeps, interfaces=self.interfaces, rest=rest)[rows]
        self._check_guarded(changes, guards.features)
        return changes

    def _check_guarded(self, X: Real, features: int) -> None:
        """Raises InputError unless sweeps have as many features as a guard takes."""
        if X.shape[1] != features:
            given = f"a guard takes {features} features, and the sweeps have {X.shape[1]}"
            raise InputError(f"{self.source}: {given}")

    def fault_kinds(self, sweeps: xr.Dataset) -> NDArray[np.str_]:
        """Kind of the fault that each sweep resembles, shape (sweep,).

        "" for sweeps that resemble no fault, and if the training had no faults.
        """
        if self.diagnosis is None or not sweeps.sizes["sweep"]:
            return np.full(sweeps.sizes["sweep"], "")
        found = np.full(sweeps.sizes["sweep"], "", dtype=object)
        X, rows = diagnosis_features(sweeps, self.interfaces)
        if rows.size:
            self._check_guarded(X, next(iter(self.diagnosis.guards.values())).features)
            found[rows] = self.diagnosis.kinds(X)
        return found.astype(str)

    def faults(self, sweeps: xr.Dataset, answers: Answers) -> NDArray[np.str_]:
        """Fault that each sweep without an answer resembles, or "", shape (sweep,).

        answers: those of `localize` to these sweeps. Only a model that was trained on a data set
        with faults names them.
        """
        found = np.full(answers.answered.size, "", dtype=object)
        silent = np.flatnonzero(~answers.answered)
        found[silent] = self.fault_kinds(sweeps.isel(sweep=silent))
        return found.astype(str)

    def samples(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> Samples:
        """Features and targets of the sweeps that have the model's target.

        Raises InputError as `usable_features`, and as `samples_of`.
        """
        check_compatible(self.problem, sweeps, rest, any_skin=self.any_skin)
        return samples_of(
            sweeps, self.target, self.quantities, interfaces=self.interfaces, rest=rest
        )

    def predict(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> NDArray:
        """The best class of each sweep, shape (sweep,), or positions, shape (sweep, 3).

        Raises InputError as `features`.
        """
        return self.predictor.predict(self.features(sweeps, rest))

    def probabilities(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None = None
    ) -> tuple[NDArray, Real]:
        """Classes, shape (K,), and their calibrated probabilities, shape (sweep, K).

        All probabilities are equal for a sweep without a baseline before it. sweeps: sweeps to
        localize. rest: baseline sweeps, if the model needs them and they are not among `sweeps`.
        Raises InputError for sweeps unlike those of the training, and for a model of positions.
        """
        if isinstance(self.learned, Regressor):
            raise InputError("a model of positions gives deviations, not probabilities")
        X, rows = self.usable_features(sweeps, rest)
        found = np.full((sweeps.sizes["sweep"], len(self.classes)), 1 / len(self.classes))
        if rows.size:
            found[rows] = self.learned.probabilities(X)
        return self.learned.classes, found

    def positions(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> tuple[Real, Real]:
        """Centre in mm and strength of a touch, and their standard deviations, (sweep, 3) each.

        Every sweep gets a position; `answers` says if there is one touch. Both are NaN for a sweep
        without a baseline before it. sweeps, rest: as for `probabilities`. Raises InputError for
        sweeps unlike those of the training, and for a model of classes.
        """
        if isinstance(self.learned, Classifier):
            raise InputError(f"a model of `target` {self.target} gives no positions")
        X, rows = self.usable_features(sweeps, rest)
        place, deviation = np.full((2, sweeps.sizes["sweep"], 3), np.nan)
        if rows.size:
            place[rows], deviation[rows] = self.learned.positions(X)
        return place, deviation

    def regions(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> list[Region | None]:
        """The smallest region that contains the touch with 95 % probability, for each sweep.

        None for a sweep without a baseline before it. For regressors without a posterior it is the
        ellipse of their deviations. sweeps, rest: as for `probabilities`. Raises InputError for
        sweeps unlike those of the training, and for a model of classes.
        """
        if isinstance(self.learned, Classifier):
            raise InputError(f"a model of `target` {self.target} gives no regions")
        X, rows = self.usable_features(sweeps, rest)
        found = (
            regions_of(self.learned, X, self.scene and self.scene.parts.skin) if rows.size else []
        )
        regions = dict(zip(rows.tolist(), found, strict=True))
        return [regions.get(row) for row in range(sweeps.sizes["sweep"])]

    def answers(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> Answers:
        """Class or CANNOT_TELL for each sweep, and its probability.

        A model of positions answers "0" touches, "1" touch, or CANNOT_TELL. A sweep without a
        baseline before it gets CANNOT_TELL, and so does one with a reading that is no finite
        number, or one that resembles a misleading fault.
        Raises InputError as `usable_features`.
        """
        found = self._answers(sweeps, rest)
        if self.diagnosis is None or not self.diagnosis.misleading:
            return found
        refused = np.isin(self.fault_kinds(sweeps), self.diagnosis.misleading)
        labels = np.where(refused, CANNOT_TELL, found.labels)
        return replace(found, labels=labels, novel=found.novel | refused)

    def _answers(self, sweeps: xr.Dataset, rest: xr.Dataset | None) -> Answers:
        """Answers without regard to faults, see `answers`."""
        X, rows = self.usable_features(sweeps, rest)
        guess = 1 / len(self.classes) if self.classes else 1.0
        if not rows.size:
            none = np.empty(0)
            nothing = Answers(none.astype(str), none, none > 0, np.empty((0, len(self.classes))))
            return nothing.among(rows, sweeps.sizes["sweep"], guess)
        if isinstance(self.learned, Classifier):
            answers = self.learned.answers(X, self.guard_changes(sweeps, rest, rows))
            return answers.among(rows, sweeps.sizes["sweep"], guess)
        novel = self.learned.novel(X, self.guard_changes(sweeps, rest, rows))
        if self.gate is None:
            labels, of_no_class = np.where(novel, CANNOT_TELL, ONE_TOUCH), np.empty((novel.size, 0))
            one = Answers(labels, np.ones(novel.size), novel, of_no_class)
            return one.among(rows, sweeps.sizes["sweep"], guess)
        counted = self.gate.answers(sweeps, rest)
        novel_places = np.zeros(counted.novel.size, dtype=bool)
        novel_places[rows] = novel
        unplaced = (novel_places & (counted.labels == ONE_TOUCH)) | (counted.labels == "2")
        labels = np.where(unplaced, CANNOT_TELL, counted.labels)
        of_no_class = np.empty((labels.size, 0))
        return Answers(labels, counted.probability, counted.novel | unplaced, of_no_class)
