"""A trained localizer: which pixel, row or column a sweep was pressed at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np
from sklearn.pipeline import Pipeline

from localization.classifiers import REFERENCE, pipeline
from localization.features import DEFAULT_QUANTITIES, checked_quantities, features, labels
from simulator.sweeps import InputError

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Model:
    """A fitted pipeline and what it was fitted to, so that only like sweeps are asked of it."""

    pipeline: Pipeline
    target: str
    """What it tells: "column", "row" or "pixel"."""
    quantities: tuple[str, ...]
    interfaces: tuple[str, ...]
    frequencies: tuple[float, ...]
    """Hz, ascending."""
    scene: str
    """TOML text of the skin it was trained for; empty where unknown."""
    version: str
    """Of rcskin, when it was trained."""

    def predict(self, sweeps: xr.Dataset) -> NDArray[np.int64] | NDArray[np.str_]:
        """Where each sweep was pressed, labels as of `labels`, shape (sweep,).

        Raises InputError where the sweeps have other interfaces or frequencies than in training.
        """
        self._check_like_training(sweeps)
        return self.pipeline.predict(features(sweeps, self.quantities))

    def _check_like_training(self, sweeps: xr.Dataset) -> None:
        interfaces = tuple(sweeps["interface"].values)
        if interfaces != self.interfaces:
            raise InputError(
                f"the model was trained on interfaces {', '.join(self.interfaces)}, "
                f"the sweeps have {', '.join(interfaces)}"
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
    classifier: str = REFERENCE,
    *,
    quantities: Sequence[str] = DEFAULT_QUANTITIES,
) -> Model:
    """A model that tells where sweeps like these were pressed.

    target, quantities: as of `features` and `labels`. classifier: a name in CLASSIFIERS.
    Raises InputError where the sweeps cannot be labelled or are all of one class.
    """
    y = labels(sweeps, target)
    if np.unique(y).size < 2:
        raise InputError(f"need sweeps of at least 2 classes, got {np.unique(y).size}")
    X = features(sweeps, quantities)
    return Model(
        pipeline=pipeline(classifier, features=X.shape[1]).fit(X, y),
        target=target,
        quantities=checked_quantities(quantities),
        interfaces=tuple(str(name) for name in sweeps["interface"].values),
        frequencies=tuple(float(f) for f in sweeps["frequency"].values),
        scene=str(sweeps.attrs.get("scene", "")),
        version=version("rcskin"),
    )
