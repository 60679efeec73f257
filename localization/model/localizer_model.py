"""A trained localizer: what a sweep was pressed by, or that this cannot be told."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np
from sklearn.pipeline import Pipeline

from ...simulator.safe_text import Tabular
from ...simulator.scene.scene_files import carried_scene
from ...simulator.sweeps import InputError
from ..inputs.baselines import check_baselines
from ..inputs.features import available_features, baseline_changes
from ..inputs.fingerprints import fingerprints_of
from ..inputs.samples import LocalizationProblem, Samples, samples_of
from ..inversion.region import Region
from ..inversion.regions import regions_of
from ..trust.answers import CANNOT_TELL, NOTHING_PRESSED, Answers
from ..trust.fitted import Classifier, Regressor
from .compatibility import check_compatible

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ...simulator.scene.scene import Scene


SOFTWARE = ("rcskin", "scikit-learn", "skops")
"""What made a model and its file."""


def current_versions() -> dict[str, str]:
    """Of SOFTWARE."""
    return {name: version(name) for name in SOFTWARE}


@dataclass(frozen=True, repr=False)
class Model(Tabular):
    """A trained localizer and what it was trained on, so that only like sweeps are asked of it."""

    learned: Classifier | Regressor
    estimator: str
    """Its name."""
    problem: LocalizationProblem
    certain: float | None
    """The rate at which its answers are to be right; None where it always answers."""
    validation: str
    """How sweeps were held out to find probabilities and deviations."""
    versions: dict[str, str]
    """Of SOFTWARE, when it was trained."""
    trained_on: int
    """Sweeps."""
    left_out: str
    """Which sweeps were left out, as text."""
    fingerprints: NDArray[np.uint64] = field(compare=False)
    """Of the sweeps that it was trained or adapted on, see `fingerprints_of`."""
    gate: Model | None = None
    """Of positions: tells how many touches there are; None where the training showed only one."""
    any_skin: bool = False
    """Whether it answers sweeps of another skin too."""
    source: str = field(default="the model", compare=False)
    """What errors call it: its file."""

    def _table(self) -> tuple[str, list[tuple[object, ...]]]:
        header = "target", "estimator", "features", "frequencies", "trained on", "held out"
        known = f"{self.trained_on} sweeps", self.learned.outcome
        features = ", ".join(self.quantities)
        row = (self.target, self.estimator, features, len(self.frequencies), *known)
        return "Model", [header, row]

    @property
    def version_differences(self) -> str:
        """With which other versions it was trained, as text; empty where they are those here."""
        here = current_versions()
        return ", ".join(
            f"{name} {then} (here {here[name]})"
            for name, then in self.versions.items()
            if here[name] != then
        )

    def for_any_skin(self) -> Model:
        """The same model, which answers sweeps of another skin too."""
        return replace(self, anyway=True, gate=self.gate and self.gate.for_any_skin())

    def with_fingerprints(self, sweeps: xr.Dataset) -> Model:
        """The same model, whose `marks` hold those of sweeps that it was adapted on, too."""
        return replace(self, marks=np.concatenate([self.fingerprints, fingerprints_of(sweeps)]))

    @property
    def pipeline(self) -> Pipeline:
        """The fitted pipeline."""
        return self.learned.pipeline

    @property
    def target(self) -> str:
        """What it tells, one of TARGETS."""
        return self.problem.target

    @property
    def quantities(self) -> tuple[str, ...]:
        """What it looks at, as of `features`."""
        return self.problem.quantities

    @property
    def interfaces(self) -> tuple[str, ...]:
        """Those it looks at, in that order."""
        return self.problem.interfaces

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Hz, ascending."""
        return self.problem.frequencies

    @property
    def own_frequencies(self) -> dict[str, tuple[float, ...]]:
        """Hz, ascending, of the interfaces that it looks at, by name, if some have their own."""
        return {
            name: tuple(f for f, read in zip(self.frequencies, row, strict=True) if read)
            for name, row in zip(self.interfaces, self.problem.taken, strict=False)
        }

    @property
    def scene(self) -> Scene | None:
        """The scene that it was trained for, None where unknown; raises as `carried_scene`."""
        return carried_scene(self.problem.scene, self.source)

    @property
    def known_scene(self) -> Scene:
        """The scene that it was trained for. Raises InputError as `scene`, and where unknown."""
        if self.scene is None:
            told = "was trained on sweeps that carry no scene, which is needed here"
            raise InputError(f"{self.source}: {told}")
        return self.scene

    @property
    def classes(self) -> tuple[int | str, ...]:
        """Of a classifier, what it can answer; of positions none."""
        return tuple(self.learned.classes.tolist()) if isinstance(self.learned, Classifier) else ()

    @property
    def knows_unpressed(self) -> bool:
        """Whether it can answer that nothing is pressed: it was shown the skin at rest."""
        known = self.gate.classes if self.gate else self.classes
        return any(str(label) in NOTHING_PRESSED for label in known)

    def features(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> NDArray[np.float64]:
        """What it looks at, shape (sweep, feature).

        Raises InputError as `told`, and where the skin at rest is not known before each sweep.
        """
        X, rows = self.usable_features(sweeps, rest)
        check_baselines(sweeps, rows)
        return X

    def usable_features(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
        """What it looks at of the sweeps that it can tell, (row, feature), and which these are.

        rest: sweeps of the skin at rest, where the model needs them and they are not among
        `sweeps`. Raises InputError where these or the sweeps are of another skin, as their scene
        tells, or have other frequencies than in training or lack an interface of it, and where the
        skin at rest is never seen.
        """
        check_compatible(self.problem, sweeps, rest, any_skin=self.any_skin)
        X, rows = available_features(sweeps, self.quantities, interfaces=self.interfaces, rest=rest)
        if not rows.size:
            check_baselines(sweeps, rows)
        return X, rows

    @property
    def guards_use_changes(self) -> bool:
        """Whether its guards look at changes from the skin at rest, though it itself does not."""
        return self.learned.guards is not None and self.learned.guards.changes is not None

    def guard_changes(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None, rows: NDArray[np.intp]
    ) -> NDArray[np.float64] | None:
        """Changes from the skin at rest of these rows, (row, feature), if its guards look at them.

        NaN where the skin at rest is not known: nothing is guarded by it there.
        """
        if not self.guards_use_changes:
            return None
        return baseline_changes(sweeps, interfaces=self.interfaces, rest=rest)[rows]

    def samples(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> Samples:
        """What it looks at and what it should tell, of the sweeps with such a target.

        Raises InputError as `told`, and as `samples_of`.
        """
        check_compatible(self.problem, sweeps, rest, any_skin=self.any_skin)
        return samples_of(
            sweeps, self.target, self.quantities, interfaces=self.interfaces, rest=rest
        )

    def predict(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> NDArray:
        """The best class of each sweep, shape (sweep,), or positions, shape (sweep, 3).

        Raises InputError as `features`.
        """
        return self.pipeline.predict(self.features(sweeps, rest))

    def probabilities(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None = None
    ) -> tuple[NDArray, NDArray[np.float64]]:
        """Classes, shape (K,), and their calibrated probabilities, shape (sweep, K).

        All alike for a sweep that has nothing at rest before it. Raises InputError as `told`, and
        for a model of positions.
        """
        if isinstance(self.learned, Regressor):
            raise InputError("a model of positions tells deviations, not probabilities")
        X, rows = self.usable_features(sweeps, rest)
        found = np.full((sweeps.sizes["sweep"], len(self.classes)), 1 / len(self.classes))
        found[rows] = self.learned.probabilities(X)
        return self.learned.classes, found

    def positions(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Centre in mm and strength of a touch, and their standard deviations, (sweep, 3) each.

        They are told of every sweep: whether there is one touch to place, `answers` tells. Both are
        NaN for a sweep that has nothing at rest before it. Raises InputError as `told`, and for a
        model of classes.
        """
        if isinstance(self.learned, Classifier):
            raise InputError(f"a model of `target` {self.target} tells no positions")
        X, rows = self.usable_features(sweeps, rest)
        place, deviation = np.full((2, sweeps.sizes["sweep"], 3), np.nan)
        place[rows], deviation[rows] = self.learned.positions(X)
        return place, deviation

    def regions(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> list[Region | None]:
        """The smallest region of places that holds a touch with 95 %, of each sweep, if it is told.

        Of regressors without a posterior it is the ellipse of their deviations. Raises as
        `positions`.
        """
        if isinstance(self.learned, Classifier):
            raise InputError(f"a model of `target` {self.target} tells no regions")
        X, rows = self.usable_features(sweeps, rest)
        told = dict(zip(rows.tolist(), regions_of(self.learned, X, self.scene), strict=True))
        return [told.get(row) for row in range(sweeps.sizes["sweep"])]

    def answers(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> Answers:
        """The class or CANNOT_TELL of each sweep, and its probability.

        A model of positions answers "0" touches, "1" where there is one to place, or CANNOT_TELL. A
        sweep that has nothing at rest before it cannot be told. Raises InputError as `told`.
        """
        X, rows = self.usable_features(sweeps, rest)
        if isinstance(self.learned, Classifier):
            guess = 1 / len(self.classes)
            told = self.learned.answers(X, self.guard_changes(sweeps, rest, rows))
            return told.among(rows, sweeps.sizes["sweep"], guess)
        novel = self.learned.novel(X, self.guard_changes(sweeps, rest, rows))
        if self.gate is None:
            labels, of_no_class = np.where(novel, CANNOT_TELL, "1"), np.empty((novel.size, 0))
            one = Answers(labels, np.ones(novel.size), novel, of_no_class)
            return one.among(rows, sweeps.sizes["sweep"], 1.0)
        counted = self.gate.answers(sweeps, rest)
        unlike = np.zeros(counted.novel.size, dtype=bool)
        unlike[rows] = novel
        unplaced = (unlike & (counted.labels == "1")) | (counted.labels == "2")
        labels = np.where(unplaced, CANNOT_TELL, counted.labels)
        of_no_class = np.empty((labels.size, 0))
        return Answers(labels, counted.probability, counted.novel | unplaced, of_no_class)
