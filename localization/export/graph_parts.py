"""Parts of a localizer, and features of raw readings, as nodes of a graph of ONNX.

Features follow the definitions of `inputs.features`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from ..inputs.features import ABSOLUTE, BASELINE, OF_GAIN, READ, RELATIVE
from ..inputs.samples import LocalizationProblem
from ..parts.normal_densities import OPENING, ClassDensities, NormalDensities
from ..parts.parts import (
    AffineMap,
    Components,
    DenseLayers,
    KernelSum,
    LogProbabilities,
    NearestErrors,
    PairwiseSVMs,
    Part,
    Scaling,
)
from ..trust.kinds import KindGuard
from .graph import Graph
from .portable import Distance, less_one, scaling_of

RECENT, OPENING_SWEEPS = "baseline_", "opening_"
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
            return self._baseline(ABSOLUTE[BASELINE.index(name)], OPENING_SWEEPS)
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


NO_WEIGHT = -1e30
"""ln of the weight of a part that is none: within single precision."""


@singledispatch
def add_part(part: Part, graph: Graph, x: str) -> str:
    """Adds a part to a graph. x: its input, shape (sweep, F). Returns its output (sweep, out)."""
    raise TypeError(type(part))


@add_part.register
def _(part: Scaling, graph: Graph, x: str) -> str:
    centred = graph("Sub", x, graph.real_constant(part.centre))
    return graph("Mul", centred, graph.real_constant(1 / part.scale))


@add_part.register
def _(part: Components, graph: Graph, x: str) -> str:
    centred = graph("Sub", x, graph.real_constant(part.mean))
    return graph("MatMul", centred, graph.real_constant(part.directions.T / part.scale))


@add_part.register
def _(part: AffineMap, graph: Graph, x: str) -> str:
    centred = graph("Sub", x, graph.real_constant(part.centre))
    turned = graph("MatMul", centred, graph.real_constant(part.matrix))
    return graph("Add", turned, graph.real_constant(part.offset)) if part.offset.any() else turned


@add_part.register
def _(part: KernelSum, graph: Graph, x: str) -> str:
    kernel = _kernel(graph, x, part.vectors, part.gamma)
    weighted = graph("MatMul", kernel, graph.real_constant(part.weights))
    offset = part.offset + part.weights.sum(axis=0)
    return graph("Add", weighted, graph.real_constant(offset))


@add_part.register
def _(part: PairwiseSVMs, graph: Graph, x: str) -> str:
    """The vectors of each class are filled up to one number by vectors without weight."""
    K, most = len(part.counts), int(part.counts.max())
    ends = np.cumsum([0, *part.counts])
    vectors = np.zeros((K, most, part.vectors.shape[1]))
    coefficients = np.zeros((K, most, K))
    for i, size in enumerate(part.counts):
        vectors[i, :size] = part.vectors[ends[i] : ends[i + 1]]
        coefficients[i, :size] = part.coefficients[ends[i] : ends[i + 1]]
    kernel = _kernel(graph, x, vectors.reshape(K * most, -1), part.gamma)
    by_class = graph("Reshape", kernel, graph.integers([0, K, 1, most]))
    weighted = graph("MatMul", by_class, graph.real_constant(coefficients))
    P = graph("Reshape", weighted, graph.integers([0, K, K]))
    scores = graph("Sub", P, graph("Transpose", P, perm=[0, 2, 1]))
    scores = graph("Add", scores, graph.real_constant(less_one(part)))
    return _decoded(part, graph, scores)


def _decoded(part: PairwiseSVMs, graph: Graph, scores: str) -> str:
    """Decisions, shape (sweep, class), from scores of class i against class j."""
    K = len(part.counts)
    if part.decoding == "hinge loss":
        hinge = graph("Relu", graph("Sub", 1.0, scores))  # 1 against the own class
        losses = graph("Sub", graph.sum(hinge, 2), 1.0)
        return graph("Mul", losses, -1 / (2 * (K - 1)))
    total = graph.sum(scores, 2)
    if part.decoding == "sum":
        return graph("Mul", total, 0.5)
    votes = graph.sum(graph.cast(graph("Greater", scores, 0.0)), 2)
    size = graph("Mul", graph("Add", graph("Abs", total), 1.0), 3.0)
    return graph("Add", votes, graph("Div", total, size))


@add_part.register
def _(part: DenseLayers, graph: Graph, x: str) -> str:
    """Layers in single precision, in which networks are trained and computed."""
    x = graph.cast(x, np.float32)
    for number, layer in enumerate(part.layers):
        x = graph("Relu", x) if number else x
        product = graph("MatMul", x, graph.constant(np.asarray(layer.weights, np.float32)))
        x = graph("Add", product, graph.constant(np.asarray(layer.offset, np.float32)))
    return graph.cast(x)


@add_part.register
def _(part: LogProbabilities, graph: Graph, x: str) -> str:
    """In single precision, as the network before it."""
    probabilities = graph("Softmax", graph.cast(x, np.float32), axis=1)
    smallest = graph.constant(np.asarray(part.smallest, np.float32))
    return graph.cast(graph("Log", graph("Max", probabilities, smallest)))


@add_part.register
def _(part: NormalDensities, graph: Graph, x: str) -> str:
    """Values of all parts at once, shape (sweep, part, component), in whitened components."""
    own = part.densities
    whitening = _whitening(own)
    change, curve = graph.columns(x, part.change), graph.columns(x, part.curve)
    z = add_part(part.known, graph, curve)
    one = graph("Add", graph("Mul", graph.columns(z, [0]), 0.0), 1.0) if part.curve.size else None
    terms = _terms(part, graph, change, z, one)
    if part.correction is not None:
        absolute = graph.columns(x, part.absolute)
        moved = graph("Sub", graph("Sub", absolute, change), curve)
        change = graph("Add", change, _correction(part, graph, moved))
    components = graph("MatMul", change, graph.real_constant(part.turn))
    response = _by_class(graph, components, whitening)
    touch = _by_class(graph, terms, own.by_curve @ whitening)
    first = graph.columns(terms, np.arange(own.curvature.shape[1]))
    curvature = _by_class(graph, first, own.curvature @ whitening)
    strength = graph.real_constant(own.strength)

    def inner(a: str, b: str) -> str:
        return graph.sum(graph("Mul", a, b), 2)

    wider = graph("Add", graph("Mul", strength, inner(touch, touch)), 1.0)
    along = inner(graph("Sub", response, touch), touch)
    bend = graph("Div", graph("Mul", strength, along), wider)  # t - 1
    squared = graph("Unsqueeze", graph("Mul", bend, bend), graph.integers([2]))
    left = graph("Sub", graph("Sub", response, touch), graph("Mul", squared, curvature))
    along = inner(left, touch)
    spread = graph("Div", graph("Mul", strength, graph("Mul", along, along)), wider)
    distance = graph("Sub", inner(left, left), spread)
    off = graph("Mul", graph("Add", distance, graph("Log", wider)), 0.5)
    others = part.turn.shape[1] - own.own.shape[1]
    spreads = np.log(own.own).sum(axis=1) + others * np.log(own.floor)
    joint = graph("Sub", graph.real_constant(own.prior - spreads / 2), off)
    return _summed(graph, joint, own.first, len(own.prior))


def _summed(graph: Graph, logarithms: str, first: NDArray[np.intp], parts: int) -> str:
    """ln of the sum over the parts of each class, shape (sweep, class).

    Classes with fewer parts than others are filled up by parts without weight.
    """
    counts = np.diff(np.append(first, parts))
    nth = np.arange(counts.max())
    own = nth < counts[:, None]
    each = graph.columns(logarithms, first[:, None] + np.where(own, nth, 0))
    weighted = graph("Add", each, graph.real_constant(np.where(own, 0.0, NO_WEIGHT)))
    return graph("ReduceLogSumExp", weighted, axes=[2], keepdims=0)


def _whitening(own: ClassDensities) -> Real:
    """Symmetric roots of the inverse covariances of the residuals, shape (K, c, c)."""
    roots, floor = own.axes, np.sqrt(own.floor)[:, None]
    within = (1 / np.sqrt(own.own) - 1 / floor)[:, None]
    return np.eye(roots.shape[1]) / floor[..., None] + roots * within @ roots.swapaxes(1, 2)


def _terms(part: NormalDensities, graph: Graph, change: str, z: str, one: str | None) -> str:
    """1, components of the curve, and their products, shape (sweep, term)."""
    if one is None:  # no curve: the term 1 alone
        return graph("Add", graph("Mul", graph.columns(change, [0]), 0.0), 1.0)
    pairs = np.triu_indices(min(part.squared, part.known.offset.size))
    products = [graph.columns(z, index) for index in pairs]
    return graph("Concat", one, z, graph("Mul", *products), axis=1)


def _correction(part: NormalDensities, graph: Graph, moved: str) -> str:
    assert part.correction is not None
    D = part.correction.directions
    along = graph("MatMul", moved, graph.real_constant(D))
    across = graph("Sub", moved, graph("MatMul", along, graph.real_constant(D.T)))
    size = graph.sum(graph("Mul", across, across), 1, keepdims=True)
    size = graph("Max", size, float(np.finfo(graph.real).tiny))
    believed = graph("Min", graph("Div", graph.real_constant(part.correction.noise), size), 1.0)
    return graph("Mul", graph("Mul", believed, OPENING), across)


def _by_class(graph: Graph, x: str, matrices: Real) -> str:
    """Products of each row with the matrix of each class, (sweep, class, component)."""
    K, size, width = matrices.shape
    whole = matrices.transpose(1, 0, 2).reshape(size, K * width)
    product = graph("MatMul", x, graph.real_constant(whole))
    return graph("Reshape", product, graph.integers([0, K, width]))


def _kernel(graph: Graph, x: str, vectors: Real, gamma: float) -> str:
    """exp(-gamma |x - v|²) - 1, shape (sweep, V)."""
    exponent = graph("Mul", _squared_distances(graph, x, vectors), -gamma)
    return graph("Sub", graph("Exp", exponent), 1.0)


def _squared_distances(graph: Graph, x: str, vectors: Real) -> str:
    """|x - v|² of each row and vector, as |x|² - 2 x v + |v|², at least 0; shape (sweep, V)."""
    own = graph.sum(graph("Mul", x, x), 1, keepdims=True)
    products = graph("MatMul", x, graph.real_constant(-2 * vectors.T))
    theirs = graph.real_constant(np.square(vectors).sum(axis=1))
    return graph("Relu", graph("Add", graph("Add", own, theirs), products))


def add_distance(part: Distance, graph: Graph, x: str) -> str:
    """Adds a guard to a graph: distance over limit, above 1 for novel sweeps; shape (sweep,)."""
    columns = add_part(scaling_of(part), graph, graph.columns(x, part.columns))
    if isinstance(part, KindGuard):
        return _kind_distance(part, graph, columns)
    decision = graph.sum(add_part(part.machine, graph, columns), 1)
    return graph("Mul", graph("Exp", decision), 1 / part.limit)


def _kind_distance(part: KindGuard, graph: Graph, u: str) -> str:
    components = graph("MatMul", u, graph.real_constant(part.components.directions.T))
    turned = _by_class(graph, components, part.whitening)
    means = np.einsum("kc,kcd->kd", part.means, part.whitening)
    off = graph("Sub", turned, graph.real_constant(means))
    squares = graph("ReduceMin", graph.sum(graph("Mul", off, off), 2), axes=[1], keepdims=0)
    back = graph("MatMul", components, graph.real_constant(part.components.directions))
    left = graph("Sub", u, back)
    outside = graph("Sqrt", graph.sum(graph("Mul", left, left), 1))
    farther = graph("Max", graph("Sqrt", squares), graph("Mul", outside, part.outside))
    return graph("Mul", farther, 1 / part.limit)


def add_deviations(part: NearestErrors, factor: Real, graph: Graph, places: str) -> str:
    """Adds standard deviations of positions to a graph; shape (sweep, 3)."""
    scaled = add_part(part.scaling, graph, places)
    distances = graph("Mul", _squared_distances(graph, scaled, part.places), -1.0)
    nearest = graph("TopK", distances, graph.integers([part.neighbours]), axis=1)
    squares = graph("Gather", graph.real_constant(part.squares), nearest, axis=0)
    mean = graph("ReduceMean", squares, axes=[1], keepdims=0)
    return graph("Mul", graph("Sqrt", mean), graph.real_constant(factor))
