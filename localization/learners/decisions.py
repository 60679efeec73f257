"""Decision values of any classifier."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...simulator.arrays import Real

MIN_PROBABILITY = 1e-12


def decisions(classifier: Any, X: Real) -> Real:
    """Decision for each of `classes_`, larger if more probable, shape (n, K)."""
    if hasattr(classifier, "decision_function"):
        values = classifier.decision_function(X)
        return values if values.ndim == 2 else np.column_stack([-values, values]) / 2
    return np.log(np.maximum(classifier.predict_proba(X), MIN_PROBABILITY))
