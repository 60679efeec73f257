"""A trained localizer: what a sweep was pressed by, or that this cannot be told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np
from sklearn.pipeline import Pipeline

from ...simulator.sweeps import InputError
from ...simulator.sweeps.same_skin import check_same_skin
from ..inputs.features import DEFAULT_QUANTITIES, features
from ..inputs.samples import Problem, Samples, samples_of
from ..inputs.targets import labels
from ..inversion.region import Region
from ..inversion.regions import regions_of
from ..learners.registry import Registry, chosen
from ..trust.answers import CANNOT_TELL, NOTHING_PRESSED, Answers
from ..trust.fitted import Classifier, Regressor
from ..trust.fitting import learn_classes, learn_positions
from ..trust.folds import Track, judging, told, untold

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Model:
    """A trained localizer and what it was trained on, so that only like sweeps are asked of it."""

    learned: Classifier | Regressor
    estimator: str
    """Its name."""
    problem: Problem
    certain: float | None
    """The rate at which its answers are to be right; None where it always answers."""
    validation: str
    """How sweeps were held out to find probabilities and deviations."""
    version: str
    """Of rcskin, when it was trained."""
    trained_on: int
    """Sweeps."""
    left_out: int
    """Sweeps whose press has no such target."""
    gate: Model | None = None
    """Of positions: tells how many touches there are; None where the training showed only one."""
    anyway: bool = False
    """Whether it answers sweeps of another skin too."""

    def insisting(self) -> Model:
        """The same model, which answers sweeps of another skin too."""
        return replace(self, anyway=True, gate=self.gate and self.gate.insisting())

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
    def scene(self) -> str:
        """TOML text of the skin it was trained for; empty where unknown."""
        return self.problem.scene

    @property
    def classes(self) -> tuple[int | str, ...]:
        """Of a classifier, what it can answer; of positions none."""
        return tuple(self.learned.classes.tolist()) if isinstance(self.learned, Classifier) else ()

    @property
    def knows_rest(self) -> bool:
        """Whether it can answer that nothing is pressed: it was shown the skin at rest."""
        known = self.gate.classes if self.gate else self.classes
        return any(str(label) in NOTHING_PRESSED for label in known)

    def features(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> NDArray[np.float64]:
        """What it looks at, shape (sweep, feature). Raises InputError as `predict`."""
        self._check_like_training(sweeps, rest)
        return features(sweeps, self.quantities, interfaces=self.interfaces, rest=rest)

    def samples(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> Samples:
        """What it looks at and what it should tell, of the sweeps with such a target.

        Raises InputError as `predict`, and as `samples_of`.
        """
        self._check_like_training(sweeps, rest)
        return samples_of(
            sweeps, self.target, self.quantities, interfaces=self.interfaces, rest=rest
        )

    def predict(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> NDArray:
        """The best class of each sweep, shape (sweep,), or positions, shape (sweep, 3).

        rest: sweeps of the skin at rest, where the model needs them and they are not among
        `sweeps`. Raises InputError where these or the sweeps are of another skin, as their scene
        tells, or have other frequencies than in training or lack an interface of it, and where a
        session lacks the skin at rest.
        """
        return self.pipeline.predict(self.features(sweeps, rest))

    def probabilities(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None = None
    ) -> tuple[NDArray, NDArray[np.float64]]:
        """Classes, shape (K,), and their calibrated probabilities, shape (sweep, K).

        Raises InputError as `predict`, and for a model of positions.
        """
        if isinstance(self.learned, Regressor):
            raise InputError("a model of positions tells deviations, not probabilities")
        return self.learned.classes, self.learned.probabilities(self.features(sweeps, rest))

    def positions(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Centre in mm and strength of a touch, and their standard deviations, (sweep, 3) each.

        They are told of every sweep: whether there is one touch to place, `answers` tells.
        Raises InputError as `predict`, and for a model of classes.
        """
        if isinstance(self.learned, Classifier):
            raise InputError(f"a model of `target` {self.target} tells no positions")
        return self.learned.positions(self.features(sweeps, rest))

    def regions(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> list[Region]:
        """The smallest region of places that holds a touch with 95 %, of each sweep.

        Of regressors without a posterior it is the ellipse of their deviations. Raises as
        `positions`.
        """
        if isinstance(self.learned, Classifier):
            raise InputError(f"a model of `target` {self.target} tells no regions")
        return regions_of(self.learned, self.features(sweeps, rest), self.scene)

    def answers(self, sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> Answers:
        """The class or CANNOT_TELL of each sweep, and its probability.

        A model of positions answers "0" touches, "1" where there is one to place, or CANNOT_TELL.
        Raises InputError as `predict`.
        """
        if isinstance(self.learned, Classifier):
            return self.learned.answers(self.features(sweeps, rest))
        novel = self.learned.guards.novel(self.features(sweeps, rest))
        if self.gate is None:
            return Answers(np.where(novel, CANNOT_TELL, "1"), np.ones(novel.size), novel)
        counted = self.gate.answers(sweeps, rest)
        unplaced = (novel & (counted.labels == "1")) | (counted.labels == "2")
        labels = np.where(unplaced, CANNOT_TELL, counted.labels)
        return Answers(labels, counted.probability, counted.novel | unplaced)

    def _check_like_training(self, sweeps: xr.Dataset, rest: xr.Dataset | None) -> None:
        for part in (sweeps,) if rest is None else (sweeps, rest):
            asked = str(part.attrs.get("scene", ""))
            if asked != self.scene and not self.anyway:
                check_same_skin(self.scene, asked, "the model", "trained")
        given_names = [str(name) for name in sweeps["interface"].values]
        if not set(self.interfaces) <= set(given_names):
            raise InputError(
                f"the model was trained on interfaces {', '.join(self.interfaces)}, "
                f"the sweeps have {', '.join(given_names)}"
            )
        trained, given = np.array(self.frequencies), sweeps["frequency"].values
        if given.size != trained.size:
            raise InputError(
                f"the model was trained on {trained.size} frequencies, the sweeps have {given.size}"
            )
        other = np.flatnonzero(~np.isclose(given, trained, rtol=1e-9, atol=0))
        if other.size:
            raise InputError(
                f"the model was trained at {trained[other[0]]:.12g} Hz, "
                f"the sweeps have {given[other[0]]:.12g} Hz in its place"
            )


def train(
    sweeps: xr.Dataset,
    target: str = "column",
    estimator: str | None = None,
    *,
    quantities: Sequence[str] = DEFAULT_QUANTITIES,
    interfaces: Sequence[str] | None = None,
    rest: xr.Dataset | None = None,
    certain: float | None = None,
    tune: bool = False,
    registry: Registry | None = None,
    track: Track = untold,
) -> Model:
    """A model that tells of sweeps like these what `target` asks for.

    Sweeps whose press has no such target are left out. target, quantities, interfaces, rest: as of
    `samples_of`. estimator: a name in `registry`, or that of DEFAULT_OF. certain: the rate at which
    answers are to be right on held-out sweeps; without it every sweep that is no novelty is
    answered. tune: choose the estimator's parameters by cross-validation. track: as of `Track`.
    Raises InputError where these cannot be had, or the sweeps are of one class.
    """
    made = chosen(estimator, target, registry)
    samples = samples_of(sweeps, target, quantities, interfaces=interfaces, rest=rest)
    if samples.problem.continuous:
        gate = _gate(sweeps, samples, rest, certain)
        learned = learn_positions(samples, made, tune=tune, track=track)
    else:
        gate = None
        learned = learn_classes(samples, made, certain=certain, tune=tune, track=track)
    held_out = told(judging(samples.strata, samples.sessions), samples.sessions)
    return Model(
        learned=learned,
        estimator=made.name,
        problem=samples.problem,
        certain=certain,
        validation=held_out,
        version=version("rcskin"),
        trained_on=min(len(samples.of_sessions(made.sessions).X), made.most),
        left_out=samples.left_out,
        gate=gate,
    )


def _gate(
    sweeps: xr.Dataset, samples: Samples, rest: xr.Dataset | None, certain: float | None
) -> Model | None:
    """Of the same quantities and interfaces; None where there is but one number of touches."""
    if np.unique(labels(sweeps, "touches")).size < 2:
        return None
    return train(
        sweeps,
        "touches",
        quantities=samples.problem.quantities,
        interfaces=samples.problem.interfaces,
        rest=rest,
        certain=certain,
    )
