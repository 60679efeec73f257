"""Features of raw readings as nodes of a graph, by the definitions of `inputs.features`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..inputs.feature_names import ABSOLUTE, BASELINE, OF_GAIN, READ, RELATIVE
from ..inputs.samples import LocalizationProblem
from .graph import Graph

RECENT, OPENING = "baseline_", "opening_"
"""Prefixes of inputs: latest unpressed sweeps, and unpressed sweeps of the opening."""


class GraphFeatures:
    """Features in a graph, and the inputs that they need.

    A reading of the sweep is an input of shape (sweep, interface, frequency). A baseline has shape
    (session, number, interface, frequency): the mean over its number of unpressed sweeps counts.
    There is one session for all sweeps, or one for each sweep.
    """

    def __init__(self, graph: Graph, problem: LocalizationProblem) -> None:
        self.graph = graph
        self.shape = len(problem.interfaces), len(problem.frequencies)
        whole = np.ones(self.shape, dtype=bool)
        self.taken = np.flatnonzero(np.array(problem.taken) if problem.taken else whole)

    def matrix(self, quantities: Sequence[str]) -> str:
        """Features side by side, shape (sweep, feature), in the order of `available_features`."""
        blocks = {name: self._feature(name) for name in quantities}
        own = [blocks[name] for name in quantities if name not in BASELINE]
        if own:
            size = self.graph("Shape", own[0])
            blocks |= {
                name: self.graph("Expand", blocks[name], size)
                for name in quantities
                if name in BASELINE
            }
        return self.graph("Concat", *(blocks[name] for name in quantities), axis=1)

    def _feature(self, name: str) -> str:
        """One quantity of all readings that were taken, shape (sweep or session, reading)."""
        if name in READ:
            return self._read(name)
        if name in ABSOLUTE:
            return self._absolute(name, "")
        if name in BASELINE:
            return self._baseline(ABSOLUTE[BASELINE.index(name)], OPENING)
        absolute = ABSOLUTE[RELATIVE.index(name)]
        own, recent = self._absolute(absolute, ""), self._baseline(absolute, RECENT)
        return self.graph("Sub", own, recent)

    def _baseline(self, absolute: str, prefix: str) -> str:
        return self.graph("ReduceMean", self._absolute(absolute, prefix), axes=[1], keepdims=0)

    def _absolute(self, name: str, prefix: str) -> str:
        """ln of the magnitude, or the phase, of the readings of a prefix."""
        graph = self.graph
        if name in OF_GAIN.absolute[:1]:
            return graph("Log", graph("Abs", self._read("gain", prefix)))
        if name in OF_GAIN.absolute:
            return self._wrapped(self._read("gain_phase", prefix))
        R, X = self._read("Rs", prefix), self._read("X", prefix)
        if name == "phase":
            return self._angle(R, X)
        squares = graph("Add", graph("Mul", R, R), graph("Mul", X, X))
        return graph("Mul", graph("Log", squares), 0.5)

    def _read(self, name: str, prefix: str = "") -> str:
        """Readings that were taken of an input, with the readings on the last axis."""
        free = ("session", f"{prefix}sweep") if prefix else ("sweep",)
        value = self.graph.input(f"{prefix}{name}", (*free, *self.shape))
        flat = self.graph.integers([*[0] * len(free), self.shape[0] * self.shape[1]])
        return self.graph.columns(self.graph("Reshape", value, flat), self.taken)

    def _wrapped(self, phase: str) -> str:
        """The phase plus a multiple of 2 pi, within -pi and pi."""
        turns = self.graph("Round", self.graph("Mul", phase, 1 / (2 * np.pi)))
        return self.graph("Sub", phase, self.graph("Mul", turns, 2 * np.pi))

    def _angle(self, R: str, X: str) -> str:
        """Phase of R + iX: the arctangent in single precision, then one step of Newton in double.

        onnxruntime has no arctangent of double precision, and before 1.30 no cosine. The step adds
        the phase that is left after turning back by the first value, about 1e-7 rad, whose tangent
        equals it.
        """
        graph = self.graph
        ratio = graph("Div", X, R)
        first = graph.cast(graph("Atan", graph.cast(ratio, np.float32)))
        half_turn = graph("Where", graph("Less", X, 0.0), -np.pi, np.pi)
        first = graph("Where", graph("Less", R, 0.0), graph("Add", first, half_turn), first)
        if graph.real == np.float32:
            return first
        cosine, sine = graph("Sin", graph("Add", first, np.pi / 2)), graph("Sin", first)
        across = graph("Sub", graph("Mul", X, cosine), graph("Mul", R, sine))
        along = graph("Add", graph("Mul", R, cosine), graph("Mul", X, sine))
        return graph("Add", first, graph("Div", across, along))
