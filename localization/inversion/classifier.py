"""A classifier without training: it inverts a simulator's tables by Bayes' rule.

Each tabulated touch at each strength is a normal distribution of the meter's readings. Its spread
comes from the meter's noise and the unknown parameters of the skin. Bayes' rule gives the
probability of each answer, summed over the strengths.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.validation import check_is_fitted, validate_data

from ...simulator.arrays import Mask, Real
from ...simulator.scene.scene_files import carried_scene
from ...simulator.sweeps import InputError
from .fine_tuning import MODES, fine_tuned
from .hypotheses import Hypotheses, hypotheses, labels
from .mixture import Mixture

Builder = Callable[..., Mapping[str, NDArray]]
"""Function with the arguments and the result of `simulated`."""
TARGETS = ("column", "row", "pixel", "touches", "pair")


def simulated(text: str, *arguments: Any, **options: Any) -> Mapping[str, NDArray]:
    """The simulator's tables for a scene given as TOML text, as in an estimator's file.

    Further arguments: see `templates`. Raises InputError as it does, and for a text without a
    scene.
    """
    from ...simulator.inversion.touch_templates import templates

    scene = carried_scene(text, "the model's scene")
    if scene is None:
        raise InputError("`scene` must be the TOML text of a scene, got none")
    return templates(scene, *arguments, **options)


class ModelBased(ClassifierMixin, BaseEstimator):
    """Posterior probabilities of a scene's touches.

    Parameters
    ----------
    scene: TOML text. target: one of TARGETS. builder: makes the tables, once; None for the
    simulator's.
    presses: source of the prior of strengths: "dataset" for [dataset.press], "press" for [press].
    rest_sweeps: number of sweeps of the unpressed skin whose mean the features are relative to.
    learn: what `fit` estimates from labelled sweeps. "nothing"; "skin": the parameters of the skin,
        as all sweeps are of the one skin to be localized on; "error": the model's own error, from
        sweeps of any skins.
    doubt: significance of the novelty test: a sweep is novel if its distance from every touch would
        be exceeded with less than this probability.

    Attributes
    ----------
    classes_: answers, ascending, "0,0" or 0 for the unpressed skin. mean_, directions_, along_,
    log_weight_: arrays of the `Mixture`. answer_: index in `classes_` of each entry. noise_:
    standard deviation of each feature, shape (feature,). edge_: squared distance beyond which a
    sweep is novel.
    """

    def __init__(
        self,
        scene="",
        target="pixel",
        builder: Builder | None = None,
        *,
        presses="dataset",
        rest_sweeps=20,
        learn="nothing",
        doubt=1e-3,
    ):
        self.scene = scene
        self.target = target
        self.builder = builder
        self.presses = presses
        self.rest_sweeps = rest_sweeps
        self.learn = learn
        self.doubt = doubt

    def fit(self, X=None, y=None):
        """Take the simulator's tables, and fine-tune by labelled sweeps as `learn` says.

        X: changes from the unpressed skin, dlnZ and dphase or those of gains, shape
        (sweep, feature), may be None. y: labels, shape (sweep,).
        Raises ValueError for an unknown option, for features unlike those of the tables, and for a
        label without a touch.
        """
        tables = self._tables()
        self.noise_ = tables["deviation"] * np.sqrt(1 + 1 / self.rest_sweeps)
        known = hypotheses(tables, self.target, self.noise_)
        answers = labels(known, tables["pixels"], self.target)
        self.classes_, self.answer_ = np.unique(answers, return_inverse=True)
        self.n_features_in_ = self.noise_.size
        if X is not None:
            X = validate_data(self, X, reset=False)
        if self.learn != "nothing" and X is not None and y is not None:
            known = fine_tuned(known, X / self.noise_, self._possible(y), self.learn)
        self._keep(known)
        return self

    def predict_proba(self, X):
        """Probability of each of `classes_`, shape (sweep, class)."""
        return self._posterior(X)[0]

    def predict(self, X):
        """The most probable of `classes_`, also of novel sweeps, shape (sweep,)."""
        best = self.predict_proba(X).argmax(axis=1)
        return self.classes_[best]

    def novel(self, X):
        """True if even the best fit exceeds what noise and skin allow, shape (sweep,)."""
        return self._posterior(X)[1] > self.edge_

    def log_densities(self, X, numbers: tuple[int, ...] | None = None):
        """ln density of each class, then of a sweep that is just novel, (sweep, class + 1).

        numbers: indices of the features to use; None uses all.
        """
        check_is_fitted(self)
        X = validate_data(self, X, reset=False)
        mixture, chance = self.part(numbers)
        kept = slice(None) if numbers is None else list(numbers)
        distances = mixture.distances((X / self.noise_)[:, kept])
        joint = mixture.log_joint(distances)
        classes = [joint[:, self.answer_ == k] for k in range(chance.size)]
        density = np.stack([np.logaddexp.reduce(each, axis=1) for each in classes], axis=1) - chance
        novel = (mixture.log_weight - mixture.log_chance).max() - self.novelty_limit(mixture) / 2
        return np.column_stack([density, np.full(len(X), novel)])

    def part(self, numbers: tuple[int, ...] | None) -> tuple[Mixture, Real]:
        """The mixture of these features, and ln of the chance of each class."""
        parts = self.__dict__.setdefault("_parts", {})
        if numbers not in parts:
            whole = Mixture(self.mean_, self.directions_, self.along_, self.log_weight_)
            chances = np.bincount(self.answer_, np.exp(whole.log_chance))
            some = whole if numbers is None else whole.of(np.array(numbers))
            parts[numbers] = some, np.log(chances)
        return parts[numbers]

    def novelty_limit(self, mixture: Mixture) -> float:
        """Squared distance beyond which a sweep is novel, for the features of this mixture."""
        return float(chi2.isf(self.doubt, mixture.mean.shape[1]))

    def __getstate__(self):
        """State without the cached mixtures, which are computed again when needed."""
        state: Any = super().__getstate__()
        return {name: value for name, value in state.items() if name != "_parts"}

    def _tables(self) -> Mapping[str, NDArray]:
        for name, allowed in (("target", TARGETS), ("learn", MODES)):
            if getattr(self, name) not in allowed:
                names = ", ".join(allowed)
                raise ValueError(f"`{name}` must be one of {names}, got {getattr(self, name)!r}")
        return (self.builder or simulated)(self.scene, self.target, self.presses)

    def _possible(self, y) -> Mask:
        """Entries that agree with each label, shape (sweep, entry)."""
        y = np.asarray(y)
        unknown = np.setdiff1d(y, self.classes_)
        if unknown.size:
            raise ValueError(f"the scene has no touch with the label {unknown[0]}")
        return np.searchsorted(self.classes_, y)[:, None] == self.answer_

    def _keep(self, known: Hypotheses) -> None:
        self._parts = {}
        mixture = known.mixture()
        self.mean_, self.directions_, self.along_ = mixture.mean, mixture.directions, mixture.along
        self.log_weight_ = mixture.log_weight
        self.edge_ = float(chi2.isf(self.doubt, self.noise_.size))

    def _posterior(self, X) -> tuple[Real, Real]:
        """Probabilities, and the squared distance of each sweep from the nearest entry."""
        check_is_fitted(self)
        X = validate_data(self, X, reset=False)
        mixture, _ = self.part(None)
        distances = mixture.distances(X / self.noise_)
        shares = mixture.responsibilities(distances)
        order = np.argsort(self.answer_, kind="stable")
        starts = np.searchsorted(self.answer_[order], np.arange(self.classes_.size))
        return np.add.reduceat(shares[:, order], starts, axis=1), distances.min(axis=1)
