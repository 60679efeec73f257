"""C code of a whole model: a source and its header, for a microcontroller."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np

from ...simulator.sweeps import InputError
from ...simulator.sweeps.reading_quantities import DESCRIBED
from ..inputs.feature_names import ABSOLUTE, BASELINE, READ, RELATIVE
from ..model.localizer_model import Model
from .c_parts import NoCodeError, add_code, add_distance_code
from .c_tables import CCode, comment, identifier, listed, number, string
from .description import FEATURES_VERSION, limits_of
from .portable import PortableModel

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
