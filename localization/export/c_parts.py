"""Parts of a localizer as calls of the helpers in `model.c.jinja`."""

from __future__ import annotations

from functools import singledispatch

import numpy as np

from ...simulator.arrays import Real
from ..parts.parts import (
    AffineMap,
    Components,
    DenseLayers,
    LogProbabilities,
    PairwiseSVMs,
    Part,
    Scaling,
)
from ..trust.kinds import KindGuard
from ..trust.several import SeveralGuard
from .c_tables import CCode, number
from .portable import Distance, less_one, scaling_of

DECODERS = {"hinge loss": "by_hinge_loss", "votes": "by_votes", "sum": "by_sum"}


class NoCodeError(Exception):
    """A part has no C code."""


@singledispatch
def add_code(part: Part, code: CCode, x: str, size: int) -> tuple[str, int]:
    """Adds a part to the code. x: array of its input, of this size. Returns those of its output.

    Raises NoCodeError.
    """
    raise NoCodeError(type(part).__name__)


def _next(code: CCode, x: str, size: int) -> str:
    """The array that is not x, for this number of values."""
    code.width = max(code.width, size)
    return "b" if x == "a" else "a"


@add_code.register
def _(part: Scaling, code: CCode, x: str, size: int) -> tuple[str, int]:
    y = _next(code, x, size)
    tables = [code.numbers(each) for each in (part.centre, 1 / part.scale, 0 * part.scale)]
    code.call("scaled", x, size, *tables, y)
    return y, size


@add_code.register
def _(part: Components, code: CCode, x: str, size: int) -> tuple[str, int]:
    matrix = part.directions.T / part.scale
    return _affine(code, x, size, part.mean, matrix, np.zeros(len(part.directions)))


@add_code.register
def _(part: AffineMap, code: CCode, x: str, size: int) -> tuple[str, int]:
    return _affine(code, x, size, part.centre, part.matrix, part.offset)


def _affine(
    code: CCode, x: str, size: int, centre: Real, matrix: Real, offset: Real
) -> tuple[str, int]:
    y = _next(code, x, offset.size)
    tables = [code.numbers(each) for each in (centre, matrix, offset)]
    code.call("affine", x, size, *tables, offset.size, y)
    return y, offset.size


@add_code.register
def _(part: DenseLayers, code: CCode, x: str, size: int) -> tuple[str, int]:
    last = len(part.layers) - 1
    for k, (W, b) in enumerate((each.weights, each.offset) for each in part.layers):
        y = _next(code, x, len(b))
        code.call("layer", x, size, code.numbers(W), code.numbers(b), len(b), int(k < last), y)
        x, size = y, len(b)
    return x, size


@add_code.register
def _(part: LogProbabilities, code: CCode, x: str, size: int) -> tuple[str, int]:
    code.call("softmax", x, size, "1.0f")
    code.call("logarithms", x, size, number(part.smallest))
    return x, size


@add_code.register
def _(part: PairwiseSVMs, code: CCode, x: str, size: int) -> tuple[str, int]:
    """The coefficient against the own class, which is 0, is left out."""
    K = len(part.counts)
    own = np.repeat(np.arange(K), part.counts)
    others = part.coefficients[np.arange(K) != own[:, None]].reshape(-1, K - 1)
    pairs = np.triu_indices(K, 1)
    code.work = max(code.work, 2 * len(pairs[0]))
    y = _next(code, x, K)
    tables = [code.numbers(part.vectors), code.numbers(others), code.indices(part.counts)]
    code.functions |= {"kernel", "pair_number"}
    offset = code.numbers(less_one(part)[pairs])
    code.call("pairwise", x, size, *tables, offset, K, number(part.gamma), "work")
    code.call(DECODERS[part.decoding], "work", K, y)
    return y, K


def add_distance_code(part: Distance, code: CCode, x: str) -> None:
    """Adds a guard to the code. x: array of its features."""
    size = len(part.columns)
    columns = code.indices(part.columns)
    scaling = scaling_of(part)
    given = [x, columns, size, code.numbers(scaling.centre), code.numbers(1 / scaling.scale)]
    if isinstance(part, KindGuard):
        kinds, width = part.means.shape
        code.work = max(code.work, size + width)
        arrays = part.components.directions, part.means, part.whitening
        tables = [code.numbers(each) for each in arrays]
        counts = [width, kinds]
        factors = [number(part.outside), number(1 / part.limit)]
        code.call("kind_distance", *given, *tables, *counts, *factors, "work", result="distance = ")
    else:
        _add_several(part, code, given)
    code.statements.append("known = known && distance <= 1.0f;")
    code.statements.append("farthest = distance > farthest ? distance : farthest;")


def _add_several(part: SeveralGuard, code: CCode, given: list[object]) -> None:
    machine = part.machine
    code.work = max(code.work, len(part.columns))
    code.functions.add("kernel")
    tables = [code.numbers(machine.vectors), code.numbers(machine.weights)]
    offset = number((machine.offset + machine.weights.sum(axis=0))[0])
    numbers = [len(machine.vectors), number(machine.gamma), offset]
    limit = number(1 / part.limit)
    code.call("several_distance", *given, *tables, *numbers, limit, "work", result="distance = ")
