"""A classifier without training: it inverts a simulator's tables by Bayes' rule.

Each tabulated touch at each strength is a normal distribution of the meter's readings. Its spread
comes from the meter's noise and the unknown parameters of the skin. Bayes' rule gives the
probability of each answer, summed over the strengths.

Labelled touches fine-tune the skin's parameters or the model's error. In both modes the
probabilities of strengths follow the observed ones.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri, softmax

from ...simulator.arrays import Mask, Real
from ...simulator.scene.scene_files import carried_scene
from ...simulator.sweeps import InputError
from ..parts.plain import Plain, Sizes, require, transient
from ..parts.predictor import MIN_PROBABILITY, Classes, Predictor
from .hypotheses import NONE, Hypotheses, Mixture, hypotheses, labels

Mode = Literal["nothing", "skin", "error"]
PRIOR_STRENGTHS = 20.0
"""Weight of the prior of strengths, as a number of touches."""
PRIOR_ERRORS = 10.0
"""Weight of the prior of no model error, as a number of touches."""


def fine_tuned(known: Hypotheses, X: Real, possible: Mask, mode: Mode) -> Hypotheses:
    """Hypotheses after labelled sweeps. X: in units of noise, shape (sweep, number).

    possible: entries that agree with each label, shape (sweep, entry). Sweeps of the unpressed skin
    are not used. mode: "skin": all touches are of one skin, whose parameters are estimated;
    "error": touches are of any skins, and give a bias and further spread of the model.
    """
    pressed = ~possible[:, (known.place == NONE).all(axis=1)].any(axis=1)
    X, possible = X[pressed], possible[pressed]
    if not len(X):
        return known
    mixture = known.mixture()
    joint = np.where(possible, mixture.log_joint(mixture.distances(X)), -np.inf)
    shares = softmax(joint, axis=1)
    fit = _with_fitted_skin if mode == "skin" else _with_fitted_error
    fitted = fit(known, X, shares.argmax(axis=1))
    return replace(fitted, strengths=_strengths(known, shares.sum(axis=0)))


def _with_fitted_skin(known: Hypotheses, X: Real, entry: NDArray[np.intp]) -> Hypotheses:
    """Update the normal unknowns z of the skin; a sweep of strength t is m + J t + A z."""
    unknowns = known.skin.shape[-1]
    precision, pull = np.eye(unknowns), np.zeros(unknowns)
    for x, e in zip(X, entry, strict=True):
        J, A = np.split(known.spread(np.array([e]))[0], [known.slope.shape[2]], axis=1)
        off, inner = x - known.means(np.array([e]))[0], np.eye(J.shape[1]) + J.T @ J
        left = A - J @ np.linalg.solve(inner, J.T @ A)
        precision += A.T @ left
        pull += left.T @ off
    covariance = np.linalg.inv(precision)
    return replace(
        known,
        shift=known.shift + known.skin @ (covariance @ pull),
        skin=known.skin @ np.linalg.cholesky((covariance + covariance.T) / 2),
    )


def _with_fitted_error(known: Hypotheses, X: Real, entry: NDArray[np.intp]) -> Hypotheses:
    """Add a bias and further directions from the residuals of the best fits, if above noise."""
    left = np.array([_residual(known, x, e) for x, e in zip(X, entry, strict=True)])
    count, numbers = len(left), X.shape[1]
    bias = left.sum(axis=0) / (count + PRIOR_ERRORS)
    scatter = (left - bias).T @ (left - bias) / (count + PRIOR_ERRORS)
    power, turn = np.linalg.eigh(scatter)
    by_chance = (1 + np.sqrt(numbers / count)) ** 2
    found = power > by_chance
    columns = turn[:, found] * np.sqrt(power[found] - 1)
    further = np.broadcast_to(columns, (*known.skin.shape[:3], columns.shape[1]))
    return replace(
        known,
        shift=known.shift + bias,
        skin=np.concatenate([known.skin, further], axis=3),
    )


def _residual(known: Hypotheses, x: Real, entry: int) -> Real:
    """Residual of a sweep after strength and skin are fitted."""
    one = np.array([entry])
    B, off = known.spread(one)[0], x - known.means(one)[0]
    return off - B @ np.linalg.solve(np.eye(B.shape[1]) + B.T @ B, B.T @ off)


def _strengths(known: Hypotheses, met: Real) -> Real:
    """Probabilities of strengths. met: number of touches of each entry, shape (entry,)."""
    there = known.strength != NONE
    counts = np.bincount(
        known.strength[there],
        np.broadcast_to(met[:, None], there.shape)[there],
        minlength=known.strengths.size,
    )
    return (PRIOR_STRENGTHS * known.strengths + counts) / (PRIOR_STRENGTHS + counts.sum())


Builder = Callable[..., Mapping[str, NDArray]]
"""Function with the arguments and the result of `simulated`."""


def simulated(text: str, *arguments: Any, **options: Any) -> Mapping[str, NDArray]:
    """The simulator's tables for a scene given as TOML text, as in an estimator's file.

    Further arguments: see `templates`. Raises InputError as it does, and for a text without a
    scene.
    """
    from ...simulator.inversion.touch_templates import templates

    scene = carried_scene(text, "the model's scene")
    if scene is None:
        raise InputError("`scene` must be the TOML text of a scene, got none")
    return templates(scene.parts, *arguments, **options)


def novelty_limit(significance: float, numbers: int) -> float:
    """Squared distance that as many normal numbers exceed with this probability."""
    return float(chdtri(numbers, significance))


@dataclass(frozen=True)
class InversionPlan(Plain):
    """How a scene's touches are tabulated.

    scene: TOML text. target: the prediction. presses: source of the prior of strengths: "dataset"
    for [dataset.press], "press" for [press]. rest_sweeps: number of sweeps of the unpressed skin
    whose mean the features are relative to. learn: what a fit estimates from labelled sweeps.
    "nothing"; "skin": the parameters of the skin, as all sweeps are of the one skin to be localized
    on; "error": the model's own error, from sweeps of any skins. doubt: significance of the novelty
    test: a sweep is novel if its distance from every touch would be exceeded with less than this
    probability. builder: makes the tables, by default the simulator.
    """

    scene: str
    target: Literal["column", "row", "pixel", "touches", "pair", "position"]
    presses: Literal["dataset", "press"] = "dataset"
    rest_sweeps: Annotated[int, ">0"] = 20
    learn: Mode = "nothing"
    doubt: Annotated[float, ">0"] = 1e-3
    builder: Builder = transient(default=simulated)

    def tables(self, baseline: Real | None = None) -> Mapping[str, NDArray]:
        """The tables of the mean skin, or of that with a baseline curve, (number,)."""
        skin = {} if baseline is None else {"baseline": baseline, "averaged": self.rest_sweeps}
        return self.builder(self.scene, self.target, self.presses, **skin)

    def noise(self, tables: Mapping[str, NDArray]) -> Real:
        """Standard deviation of each change, shape (feature,)."""
        return tables["deviation"] * np.sqrt(1 + 1 / self.rest_sweeps)


@dataclass(frozen=True, eq=False)
class ModelBased(Predictor):
    """Posterior probabilities of a scene's touches.

    classes: answers, ascending, "0,0" or 0 for the unpressed skin. answer: index in `classes` of
    each entry of the mixture. noise: standard deviation of each feature, shape (feature,). doubt:
    see `InversionPlan`.
    """

    classes: Classes
    answer: Annotated[NDArray[np.intp], "E <K"]
    noise: Annotated[Real, "F >0"]
    mixture: Mixture
    doubt: Annotated[float, ">0"]
    _parts: dict[Any, tuple[Mixture, Real]] = transient(init=False, default_factory=dict)
    detects_novelty = True

    @classmethod
    def fitted(
        cls,
        plan: InversionPlan,
        X: Real | None = None,
        y: NDArray | None = None,
        baseline: Real | None = None,
    ) -> ModelBased:
        """Take the simulator's tables, and fine-tune by labelled sweeps as `learn` says.

        X: changes from the unpressed skin, dlnZ and dphase or those of gains, shape
        (sweep, feature). y: labels, shape (sweep,). baseline: see `InversionPlan.tables`. Raises
        ValueError for a label without a touch.
        """
        tables = plan.tables(baseline)
        noise = plan.noise(tables)
        known = hypotheses(tables, plan.target, noise)
        answers = labels(known, tables["pixels"], plan.target)
        classes, answer = np.unique(answers, return_inverse=True)
        if plan.learn != "nothing" and X is not None and y is not None:
            known = fine_tuned(known, X / noise, _possible(y, classes, answer), plan.learn)
        return cls(classes, answer, noise, known.mixture(), plan.doubt)

    def _check(self, sizes: Sizes) -> None:
        fits = self.mixture.mean.shape == (sizes["E"], sizes["F"])
        require(fits, "mixture", "must be of as many entries and features")
        touched = np.bincount(self.answer, minlength=sizes["K"]).all()
        require(touched, "answer", "must have a touch for each class")
        require(self.doubt < 1, "doubt", "must be below 1")

    @property
    def features(self) -> int:
        return self.noise.size

    def decisions(self, X: Real) -> Real:
        return np.log(np.maximum(self.probabilities(X), MIN_PROBABILITY))

    def probabilities(self, X: Real) -> Real:
        """Probability of each class, shape (sweep, class)."""
        shares = self.mixture.responsibilities(self.mixture.distances(X / self.noise))
        order = np.argsort(self.answer, kind="stable")
        starts = np.searchsorted(self.answer[order], np.arange(self.classes.size))
        return np.add.reduceat(shares[:, order], starts, axis=1)

    def novel(self, X: Real) -> Mask:
        limit = novelty_limit(self.doubt, self.noise.size)
        return self.mixture.distances(X / self.noise).min(axis=1) > limit

    def log_densities(self, X: Real, numbers: tuple[int, ...] | None = None) -> Real:
        """ln density of each class, then of a sweep that is just novel, (sweep, class + 1).

        numbers: indices of the features to use; None uses all.
        """
        mixture, chance = self.part(numbers)
        kept = slice(None) if numbers is None else list(numbers)
        distances = mixture.distances((X / self.noise)[:, kept])
        joint = mixture.log_joint(distances)
        classes = [joint[:, self.answer == k] for k in range(chance.size)]
        density = np.stack([np.logaddexp.reduce(each, axis=1) for each in classes], axis=1) - chance
        limit = novelty_limit(self.doubt, mixture.mean.shape[1])
        novel = (mixture.log_weight - mixture.log_chance).max() - limit / 2
        return np.column_stack([density, np.full(len(X), novel)])

    def part(self, numbers: tuple[int, ...] | None) -> tuple[Mixture, Real]:
        """The mixture of these features, and ln of the chance of each class."""
        if numbers not in self._parts:
            chances = np.bincount(self.answer, np.exp(self.mixture.log_chance))
            some = self.mixture if numbers is None else self.mixture.of(np.array(numbers))
            self._parts[numbers] = some, np.log(chances)
        return self._parts[numbers]


def _possible(y: NDArray, classes: NDArray, answer: NDArray[np.intp]) -> Mask:
    """Entries that agree with each label, shape (sweep, entry)."""
    unknown = np.setdiff1d(y, classes)
    if unknown.size:
        raise ValueError(f"the scene has no touch with the label {unknown[0]}")
    return np.searchsorted(classes, y)[:, None] == answer
