"""The graph of a whole model, from raw readings to answers, and what its file says about it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ..model.localizer_model import Model
from ..parts.parts import LogProbabilities
from .description import described
from .graph import Graph
from .graph_parts import GraphFeatures, add_deviations, add_distance, add_part
from .portable import PortableModel

if TYPE_CHECKING:
    from onnx import ModelProto


def onnx_model(model: Model, parts: PortableModel, *, single: bool = False) -> ModelProto:
    """The graph of a model, with its description as metadata. single: single precision."""
    graph = Graph(single)
    features = GraphFeatures(graph, parts.problem)
    if model.target == "position":
        _add_positions(parts, graph, features)
    else:
        _add_classes(parts, graph, features)
    made = graph.model(f"{model.target} by {model.estimator}")
    add_metadata(made, described(model, parts, tuple(graph.inputs)))
    return made


def add_metadata(model: ModelProto, entries: Mapping[str, object]) -> None:
    """Adds entries to the metadata of a graph; what is no text becomes JSON."""
    for key, value in entries.items():
        entry = model.metadata_props.add()
        entry.key, entry.value = key, value if isinstance(value, str) else json.dumps(value)


def _add_classes(parts: PortableModel, graph: Graph, features: GraphFeatures) -> None:
    probabilities, label = _answers(parts, graph, features)
    graph.output("probabilities", probabilities, ("sweep", len(parts.labels)))
    graph.output("label", label, ("sweep",), np.int64)
    if parts.guarded:
        graph.output("novelty", _novelty(parts, graph, features)[0], ("sweep",))


def _add_positions(parts: PortableModel, graph: Graph, features: GraphFeatures) -> None:
    place = _decisions(parts, graph, features)
    assert parts.spread is not None
    graph.output("position", place, ("sweep", 3))
    graph.output(
        "deviation", add_deviations(parts.spread, parts.factor, graph, place), ("sweep", 3)
    )
    gate = parts.gate
    if gate is None:
        label = graph("Cast", graph("Mul", graph.sum(place, 1), 0.0), to=7)
    else:
        probabilities, label = _answers(gate, graph, features)
        graph.output("probabilities", probabilities, ("sweep", len(gate.labels)))
        for several in {"2"} & {*gate.labels}:
            label = _silenced(graph, label, gate.labels.index(several))
    if parts.guarded:
        novelty, known = _novelty(parts, graph, features)
        graph.output("novelty", novelty, ("sweep",))
        label = _silenced(graph, label, parts.labels.index("1"), graph("Not", known))
    graph.output("label", label, ("sweep",), np.int64)


def _silenced(graph: Graph, label: str, number: int, where: str | None = None) -> str:
    """The label, -1 in place of this number (where a condition holds)."""
    here = graph("Equal", label, graph.integers(number))
    here = here if where is None else graph("And", here, where)
    return graph("Where", here, graph.integers(-1), label)


def _decisions(parts: PortableModel, graph: Graph, features: GraphFeatures) -> str:
    value = features.matrix(parts.problem.quantities)
    for part in parts.chain:
        value = add_part(part, graph, value)
    return value


def _answers(parts: PortableModel, graph: Graph, features: GraphFeatures) -> tuple[str, str]:
    """Probabilities, (sweep, class), and the number of the answer or -1, (sweep,)."""
    decisions = _decisions(parts, graph, features)
    of_network = isinstance(parts.chain[-1], LogProbabilities)  # all in single precision
    sharpness = np.asarray(parts.sharpness, np.float32 if of_network else graph.real)
    scaled = graph("Mul", graph.cast(decisions, sharpness.dtype), graph.constant(sharpness))
    probabilities = graph.cast(graph("Softmax", scaled, axis=1))
    best = graph("ArgMax", probabilities, axis=1, keepdims=0)
    highest = graph("ReduceMax", probabilities, axes=[1], keepdims=0)
    sure = graph("GreaterOrEqual", highest, parts.threshold)
    if parts.guarded:
        sure = graph("And", sure, _novelty(parts, graph, features)[1])
    return probabilities, graph("Where", sure, best, graph.integers(-1))


def _novelty(parts: PortableModel, graph: Graph, features: GraphFeatures) -> tuple[str, str]:
    """The largest distance of the guards, and True for known sweeps; shape (sweep,)."""
    own = features.matrix(parts.problem.quantities)
    distances = [add_distance(each, graph, own) for each in parts.distances]
    if parts.change_distances:
        changes = features.matrix(parts.change_quantities)
        unknown = graph("IsNaN", graph.sum(changes, 1))
        for each in parts.change_distances:
            distance = add_distance(each, graph, changes)
            distances.append(graph("Where", unknown, 0.0, distance))
    known = graph("LessOrEqual", distances[0], 1.0)
    for each in distances[1:]:
        known = graph("And", known, graph("LessOrEqual", each, 1.0))
    return graph("Max", *distances), known
