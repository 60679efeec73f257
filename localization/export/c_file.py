"""C code of a whole model: a source and its header, for a microcontroller.

Parts of a localizer are calls of the helpers in `model.c.jinja`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import singledispatch
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ...simulator.arrays import Real
from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import DESCRIBED
from ..inputs.features import ABSOLUTE, BASELINE, READ, RELATIVE
from ..model.localizer_model import Model
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
from .description import FEATURES_VERSION, limits_of
from .portable import Distance, PortableModel, less_one, scaling_of

A_LINE = 6
"""Numbers on a line of a table."""


@dataclass
class CTable:
    """A constant table. kind: type in C. content: its numbers as text."""

    name: str
    kind: str
    size: int
    content: str


@dataclass
class CCode:
    """What a model adds to the templates of C code.

    statements: lines of the function that localizes. functions: names of the helpers in use.
    width: largest number of values between two statements. work: size of the scratch array.
    table_bytes: bytes of all tables.
    """

    tables: list[CTable] = field(default_factory=list)
    statements: list[str] = field(default_factory=list)
    functions: set[str] = field(default_factory=set)
    width: int = 1
    work: int = 1
    table_bytes: int = 0

    def numbers(self, values: ArrayLike) -> str:
        """Name of a new table of single precision, row by row."""
        single = np.asarray(values, dtype=np.float64).astype(np.float32).ravel()
        return self._table("float", 4, [number(each) for each in single])

    def indices(self, values: ArrayLike) -> str:
        """Name of a new table of integers below 2**16."""
        return self._table("unsigned short", 2, [str(int(each)) for each in np.ravel(values)])

    def _table(self, kind: str, size: int, parts: list[str]) -> str:
        lines = [", ".join(parts[k : k + A_LINE]) for k in range(0, len(parts), A_LINE)]
        content = ",\n    ".join(lines)
        for known in self.tables:
            if (known.kind, known.content) == (kind, content):
                return known.name
        name = f"table_{len(self.tables)}"
        self.tables.append(CTable(name, kind, len(parts), content))
        self.table_bytes += size * len(parts)
        return name

    def call(self, function: str, *arguments: object, result: str = "") -> None:
        """Adds the statement that calls a helper."""
        self.functions.add(function)
        text = ", ".join(map(str, arguments))
        self.statements.append(f"{result}{function}({text});")


def number(value: float | np.floating) -> str:
    """A number of single precision in C."""
    text = str(np.float32(value))
    return f"{text}f" if re.search(r"[.e]", text) else f"{text}.0f"


def identifier(text: str) -> str:
    """The text as an identifier of C."""
    name = re.sub(r"[^a-z0-9_]", "_", text.lower()).strip("_")
    return name if name[:1].isalpha() else f"model_{name}"


def string(text: str) -> str:
    """A string literal of C: bytes of UTF-8, with an escape for all but plain characters."""
    plain = {*range(0x20, 0x7F)} - {*b'"\\?'}
    return '"' + "".join(chr(b) if b in plain else f"\\{b:03o}" for b in text.encode()) + '"'


def comment(text: str) -> str:
    """The text within a comment of C."""
    return " ".join(ascii(text)[1:-1].replace("*/", "* /").replace("/*", "/ *").split())


def listed(items: Iterable[str]) -> str:
    """Items of an initializer."""
    return ", ".join(items)


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


TOLERANCE = 2e-3
"""Largest difference of a probability in single precision from the model's."""
FOR_C = "ksvm-ovo, ksvm-components and network"
BASELINES = ("recent", RELATIVE), ("opening", BASELINE)
"""Baselines by name, and the features that need each."""
PARTS_OF_READINGS = {
    "lnZ": ("Rs", "X"),
    "phase": ("Rs", "X"),
    "lnG": ("gain",),
    "phaseG": ("gain_phase",),
}
"""Readings from which logarithms and phases are computed."""


@dataclass(frozen=True)
class CFiles:
    """C code of a model. source, header: text. flash: bytes of its tables. stack: bytes of its
    arrays. baseline: bytes of one baseline, 0 if it takes none."""

    source: str
    header: str
    flash: int
    stack: int
    baseline: int


def c_files(model: Model, parts: PortableModel, stem: str) -> CFiles:
    """C code of a model of classes. stem: name of the files without ending.

    Raises InputError if the model has a part without C code.
    """
    if model.target == "position":
        raise InputError(f"{model.source}: C code is for classes, and this predicts positions")
    code = CCode()
    try:
        _add_localizer(parts, code)
    except NoCodeError:
        reason = f"C code is for models of {FOR_C}, and this is of {model.estimator}"
        raise InputError(f"{model.source}: {reason}: export it as .onnx") from None
    values = _template_values(model, parts, code, stem)
    readings, baselines = values["readings"], values["baselines"]
    one_baseline = 4 * (1 + readings * len(values["stored"])) if baselines else 0
    widths = [parts.problem.features, len(parts.change_quantities) * readings, 2 * code.width]
    stack = 4 * (sum(widths) + code.work)
    sizes = {"flash": code.table_bytes, "stack": stack, "baseline_bytes": one_baseline}
    source, header = (_filled(f"model.{end}.jinja", values | sizes) for end in "ch")
    return CFiles(source, header, code.table_bytes, stack, one_baseline)


def _add_localizer(parts: PortableModel, code: CCode) -> None:
    x, size = "x", parts.problem.features
    for part in parts.chain:
        x, size = add_code(part, code, x, size)
    code.call("softmax", x, size, number(parts.sharpness))
    code.statements.append(f"copied({x}, {size}, probabilities);")
    for each in parts.distances:
        add_distance_code(each, code, "x")
    if parts.change_distances:
        code.statements.append("if (recent->count > 0) {")
        for each in parts.change_distances:
            add_distance_code(each, code, "changes")
        code.statements.append("}")


def _template_values(model: Model, parts: PortableModel, code: CCode, stem: str) -> dict:
    problem, name = model.problem, identifier(stem)
    used = (*problem.quantities, *parts.change_quantities)
    own = _absolute(used, (*ABSOLUTE, *RELATIVE))
    stored = _absolute(used, (*RELATIVE, *BASELINE))
    read = [each for each in used if each in READ]
    whole = np.ones((len(problem.interfaces), len(problem.frequencies)), dtype=bool)
    taken = np.flatnonzero(np.array(problem.taken) if problem.taken else whole)
    baselines = [prefix for prefix, names in BASELINES if set(names) & set(used)]
    return {
        "stem": comment(stem),
        "name": name,
        "NAME": name.upper(),
        "version": version("rcskin"),
        "features_version": FEATURES_VERSION,
        "target": comment(model.target),
        "estimator": comment(model.estimator),
        "feature_names": comment(", ".join(problem.quantities)),
        "validation": comment(f"{model.validation}: {model.learned.outcome}"),
        "tolerance": TOLERANCE,
        "limits": [comment(each) for each in limits_of(model, parts)],
        "guarded": parts.guarded,
        "interfaces": [string(each) for each in problem.interfaces],
        "frequencies": listed(number(each) for each in problem.frequencies),
        "frequency_count": len(problem.frequencies),
        "labels": [string(each) for each in parts.labels],
        "inputs": _inputs(own, read),
        "baseline_inputs": _inputs(stored, ()),
        "units": {each: DESCRIBED[each].units for each in _inputs(own, read)},
        "baselines": baselines,
        "needed": [prefix for prefix, names in BASELINES if set(names) & set(problem.quantities)],
        "own": own,
        "stored": stored,
        "readings": len(taken),
        "taken": None if taken.size == whole.size else listed(map(str, taken)),
        "features": [_expression(each) for each in problem.quantities],
        "changes": [_expression(each) for each in parts.change_quantities],
        "threshold": number(parts.threshold),
        "code": code,
    }


def _absolute(used: Sequence[str], names: Sequence[str]) -> list[str]:
    """Logarithms and phases behind the used features of these names."""
    found = {ABSOLUTE[_place(each)] for each in used if each in names}
    return sorted(found, key=ABSOLUTE.index)


def _inputs(absolute: Sequence[str], read: Sequence[str]) -> list[str]:
    """Readings behind logarithms and phases, and those that are features themselves."""
    parts = {part for each in absolute for part in PARTS_OF_READINGS[each]}
    return sorted(parts | set(read), key=[*DESCRIBED].index)


def _place(name: str) -> int:
    """Number of a quantity among those of its kind: absolute, relative or of the baseline."""
    return next(names.index(name) for names in (ABSOLUTE, RELATIVE, BASELINE) if name in names)


def _expression(name: str) -> str:
    """A feature of reading r in C."""
    if name in READ:
        return f"{name}[k]"
    absolute = ABSOLUTE[_place(name)]
    if name in ABSOLUTE:
        return f"own_{absolute}"
    if name in BASELINE:
        return f"opening->{absolute}[r]"
    return f"own_{absolute} - recent->{absolute}[r]"


def _filled(template: str, values: dict[str, object]) -> str:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=False,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template(template).render(values)


def sizes_in_words(files: CFiles) -> str:
    """Flash and RAM of C code, as text."""
    baseline = f", {files.baseline / 1e3:.1f} kB for each baseline" if files.baseline else ""
    tables = f"tables of {files.flash / 1e3:.1f} kB in flash"
    return f"{tables}, {files.stack / 1e3:.1f} kB of stack{baseline}"
