"""The page of the public names of `import rcskin`, made from their docstrings."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import rcskin

HEAD = """# Every name of `import rcskin`

`python docs/generate.py` writes this page from the docstrings. `help(rcskin.sweep)` prints the same
in Python. Quantities are in SI units unless a unit is given. A wrong argument raises `InputError`;
its message is one line with the argument, the value and the allowed range. The examples run in this
order, after:

```python
import numpy as np
import rcskin
```
"""
EXAMPLES = {
    "load": """scene = rcskin.load("strip-1x3")
scene = scene.with_({"dataset.session.sweeps_per_session": 50})""",
    "sweep": """sweeps = rcskin.sweep(scene, ["none", "1,2", "1,1:1.5+1,3"], rtol=1e-3)""",
    "measured": """recorded = rcskin.measured(sweeps, seed=2)""",
    "write": """rcskin.write(recorded, "run.nc")""",
    "read": """recorded = rcskin.read("run.nc")""",
    "plot": """rcskin.plot(recorded, "run.png", ["Rs", "change-Cp"])""",
    "dataset": """skins = rcskin.dataset(scene, 100, seed=1, rtol=1e-3)
unseen = rcskin.dataset(scene, 50, seed=2, rtol=1e-3)""",
    "features": """X, y = rcskin.features(skins, "column", "dlnZ,dphase")""",
    "train": """model = rcskin.train(skins, "column")
rcskin.write(model, "columns.skops")""",
    "load_model": """model = rcskin.load_model("columns.skops")""",
    "localize": """answers = rcskin.localize(model, recorded)
print(answers.labels, answers.probability)""",
    "evaluate": """print(rcskin.evaluate(model, unseen).accuracy)""",
    "reduce": """reduced = rcskin.reduce(scene, rtol=1e-3)
Z = reduced.impedance("1,2", np.array([1e3, 1e4]))  # ohm, shape (interface, frequency)""",
    "limits": """accuracy, standard_error = rcskin.limits(scene, "column", draws=100)""",
    "calibrate": """found = rcskin.calibrate(scene, recorded, fit=["capacitance"])
print(found.values["capacitance"], found.intervals["capacitance"])""",
    "study": """study = rcskin.study(scene, {"pixels.columns": [2, 3]}, repetitions=5)
print(study.best)""",
}
"""An example of each function, in an order in which they run."""
CLASSES = {
    "Scene": ("simulator.scene.scene", ("with_",)),
    "Press": ("simulator.press.press", ()),
    "Sensor": (
        "simulator.sensor.sensor",
        ("step", "reset", "copy", "time", "names", "units", "error", "sweeps", "last_sweep"),
    ),
    "SensorReading": (
        "simulator.sensor.sensor_reading",
        ("Rs", "X", "Cp", "gain", "gain_phase", "vector"),
    ),
    "PointContacts": ("simulator.sensor.contacts.contact_types", ()),
    "DepthImage": ("simulator.sensor.contacts.contact_types", ()),
    "PressureImage": ("simulator.sensor.contacts.contact_types", ()),
    "Model": ("localization.model.localizer_model", ("probabilities", "positions", "regions")),
    "Answers": ("localization.trust.answers", ("answered",)),
    "Evaluation": (
        "localization.evaluation.result",
        ("accuracy", "answered", "accuracy_of_answers", "calibration_error", "median_error"),
    ),
    "Reduced": ("simulator.models.reduced.reduced_model", ("impedance",)),
    "Limit": ("simulator.limits.limit", ()),
    "Calibration": ("simulator.calibration.run", ("chi_squared", "rms_error", "strengths")),
    "Study": ("localization.study.study", ("best", "spacing", "write", "plot")),
    "InputError": ("simulator.sweeps.errors", ()),
    "ToleranceError": ("simulator.sweeps.errors", ()),
}
"""Module of each class that a user meets, and its members that the page explains."""


def page() -> str:
    """The whole page, in Markdown."""
    index = [f"| [`{name}`](#{name}) | {_first(getattr(rcskin, name))} |" for name in EXAMPLES]
    index += [
        f"| [`{name}`](#class-{name.lower()}) | {_first(_class_of(name))} |" for name in CLASSES
    ]
    table = ["| name | purpose |", "| --- | --- |", *index, ""]
    functions = [line for name in EXAMPLES for line in _function(name)]
    classes = [line for name in CLASSES for line in _class(name)]
    return "\n".join([HEAD, *table, *functions, *classes]).rstrip() + "\n"


def _function(name: str) -> Iterator[str]:
    """A heading, what the function does, its arguments, its errors and the example."""
    function = getattr(rcskin, name)
    signature = inspect.signature(function)
    text, arguments, errors = parts(function, list(signature.parameters))
    yield from (f"## {name}", "", f"{_first(function)} {text}".strip(), "")
    yield from ("| argument | type | default | meaning |", "| --- | --- | --- | --- |")
    for each in signature.parameters.values():
        default = "must be given" if each.default is each.empty else f"`{each.default!r}`"
        kind = str(each.annotation).replace("|", r"\|")
        yield f"| `{each.name}` | `{kind}` | {default} | {arguments.get(each.name, '')} |"
    yield from ("", " ".join([f"Returns `{signature.return_annotation}`.", *errors]), "")
    yield from ("```python", EXAMPLES[name], "```", "")


def _class(name: str) -> Iterator[str]:
    """A heading, what the class is, and a line for each attribute and explained member."""
    kind, members = _class_of(name), CLASSES[name][1]
    text, attributes, _ = parts(kind, list(getattr(kind, "__annotations__", ())) or ["times"])
    yield from (f"## Class {name}", "", f"{_first(kind)} {text}".strip(), "")
    yield from (f"- `{each}`: {meaning}" for each, meaning in attributes.items())
    for each in members:
        member = getattr(kind, each)
        call = "" if isinstance(member, property) else "(...)"
        yield f"- `{each}{call}`: {' '.join((inspect.getdoc(member) or '').split())}"
    yield from [""] if attributes or members else []


def _class_of(name: str) -> type:
    return getattr(import_module(f"rcskin.{CLASSES[name][0]}"), name)


def parts(documented: Any, names: list[str]) -> tuple[str, dict[str, str], list[str]]:
    """The text of a docstring after its first line: in general, by name, and on errors."""
    one = "|".join(names)
    body = " ".join((inspect.getdoc(documented) or "").partition("\n")[2].split())
    general, *rest = re.split(rf"(?:^|(?<=\. ))(?=(?:(?:{one})(?:, (?:{one}))*: |Raises ))", body)
    meanings, errors = {}, []
    for part in filter(None, rest):
        if part.startswith("Raises "):
            errors.append(part.strip())
            continue
        called, _, meaning = part.partition(": ")
        meanings |= dict.fromkeys(called.split(", "), _sentence(meaning))
    return general.strip(), meanings, errors


def _first(documented: Any) -> str:
    return (inspect.getdoc(documented) or "").partition("\n")[0]


def _sentence(text: str) -> str:
    text = text.strip().replace("|", r"\|")
    return text[:1].upper() + text[1:]
