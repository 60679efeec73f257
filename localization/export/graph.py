"""A computation graph of ONNX, built node by node; equal nodes are one node."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from onnx import ModelProto

OPSET, IR_VERSION = 17, 8
"""Versions of the operators and of the file that onnxruntime 1.12 and later read."""


class Graph:
    """Nodes, constants, inputs and outputs of a graph. All numbers have one precision.

    single: True for single precision, else double.
    """

    def __init__(self, single: bool = False) -> None:
        self.real = np.dtype(np.float32 if single else np.float64)
        self.inputs: dict[str, tuple[str | int, ...]] = {}
        self._nodes: dict[tuple, Any] = {}
        self._constants: dict[str, np.ndarray] = {}
        self._outputs: dict[str, tuple[Any, tuple[str | int, ...]]] = {}

    def input(self, name: str, shape: tuple[str | int, ...]) -> str:
        """An input of real numbers. shape: numbers, and names of lengths that are free."""
        self.inputs[name] = shape
        return name

    def output(self, name: str, value: str, shape: tuple[str | int, ...], kind: Any = None) -> None:
        """Makes a value an output of this name. kind: type of its elements, real by default."""
        from onnx import helper

        self._nodes[("output", name)] = helper.make_node("Identity", [value], [name])
        self._outputs[name] = np.dtype(kind or self.real), shape

    def real_constant(self, values: ArrayLike) -> str:
        """A constant of real numbers."""
        return self.constant(np.asarray(values, self.real))

    def integers(self, values: ArrayLike) -> str:
        """A constant of integers."""
        return self.constant(np.asarray(values, np.int64))

    def constant(self, values: np.ndarray) -> str:
        """A constant; equal ones are stored once."""
        for name, known in self._constants.items():
            if known.dtype == values.dtype and np.array_equal(known, values):
                return name
        name = f"constant_{len(self._constants)}"
        self._constants[name] = values
        return name

    def __call__(self, operator: str, *values: str | float, **attributes: Any) -> str:
        """The result of an operator of ONNX. values: results, or real numbers."""
        from onnx import helper

        names = tuple(
            each if isinstance(each, str) else self.real_constant(each) for each in values
        )
        key = operator, names, repr(sorted(attributes.items()))
        if key not in self._nodes:
            outputs = [f"{operator}_{len(self._nodes)}"]
            if operator == "TopK":
                outputs.insert(0, f"{outputs[0]}_values")
            self._nodes[key] = helper.make_node(operator, names, outputs, **attributes)
        return self._nodes[key].output[-1]

    def sum(self, value: str, *axes: int, keepdims: bool = False) -> str:
        """Sum over axes."""
        return self("ReduceSum", value, self.integers(axes), keepdims=int(keepdims))

    def columns(self, value: str, index: ArrayLike) -> str:
        """Columns of the last axis."""
        return self("Gather", value, self.integers(index), axis=-1)

    def cast(self, value: str, kind: Any = None) -> str:
        """The value in another type, real by default."""
        from onnx import helper

        return self("Cast", value, to=helper.np_dtype_to_tensor_dtype(np.dtype(kind or self.real)))

    def model(self, name: str) -> ModelProto:
        """The whole graph as a checked model."""
        from importlib.metadata import version

        import onnx
        from onnx import helper, numpy_helper

        def described(names: dict) -> list:
            return [
                helper.make_tensor_value_info(each, helper.np_dtype_to_tensor_dtype(kind), shape)
                for each, (kind, shape) in names.items()
            ]

        graph = helper.make_graph(
            [*self._nodes.values()],
            name,
            described({each: (self.real, shape) for each, shape in self.inputs.items()}),
            described(self._outputs),
            [numpy_helper.from_array(each, key) for key, each in self._constants.items()],
        )
        made = helper.make_model(
            graph,
            opset_imports=[helper.make_opsetid("", OPSET)],
            ir_version=IR_VERSION,
            producer_name="rcskin",
            producer_version=version("rcskin"),
        )
        onnx.checker.check_model(made, full_check=True)
        return made
