"""The pages of the public names of `import rcskin`, made from their docstrings.

The repository stores the index. The site has a page of each name beside it.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from functools import cached_property
from importlib import import_module
from typing import Any

import rcskin

from .docstrings import call, described, errors_of, first, linked, parts, table

HEAD = """# Every name of `import rcskin`

`help(rcskin.sweep)` prints arguments, result, errors and units of a name in Python. The site has a
page of each, with an example (`python docs/site.py` builds it). Quantities are in SI units unless a
unit is given. A wrong argument raises `InputError`; its message is one line with the argument, the
value and the allowed range.
"""
GROUPS = {
    "Skins and presses": ("load", "Scene", "Press"),
    "Sweeps": ("sweep", "measured", "read", "write", "plot"),
    "Localizers": (
        *("dataset", "features", "train", "load_model", "Model", "localize", "Answers"),
        *("evaluate", "Evaluation"),
    ),
    "Models and limits": ("reduce", "Reduced", "limits", "Limit", "study", "Study"),
    "Real skins": ("calibrate", "Calibration", "gap", "GapFindings"),
    "Skins in a simulation of a robot": (
        *("Sensor", "SensorReading", "PointContacts", "DepthImage", "PressureImage"),
    ),
    "Errors": ("InputError", "ToleranceError"),
}
"""All names, in the order of the index."""
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
rcskin.write(model, "columns.npz")""",
    "load_model": """model = rcskin.load_model("columns.npz")""",
    "localize": """answers = rcskin.localize(model, recorded)
print(answers.labels, answers.probability)""",
    "evaluate": """print(rcskin.evaluate(model, unseen).accuracy)""",
    "reduce": """reduced = rcskin.reduce(scene, rtol=1e-3)
Z = reduced.solve("1,2", np.array([1e3, 1e4])).Z  # ohm, shape (interface, frequency)""",
    "limits": """accuracy, standard_error = rcskin.limits(scene, "column", draws=100)""",
    "calibrate": """found = rcskin.calibrate(scene, recorded, fit=["capacitance"])
print(found.values["capacitance"], found.intervals["capacitance"])""",
    "gap": """difference = rcskin.gap(skins, unseen, draws=1)
print(difference.summary)""",
    "study": """study = rcskin.study(scene, {"pixels.columns": [2, 3]}, repetitions=5)
print(study.best)""",
}
"""An example of each function, in an order in which they run."""
AFTER = {
    **dict.fromkeys(("sweep", "dataset", "reduce", "limits", "study"), ("load",)),
    **dict.fromkeys(("features", "train", "gap"), ("dataset",)),
    **dict.fromkeys(("write", "plot", "calibrate"), ("measured",)),
    **{"measured": ("sweep",), "read": ("write",), "load_model": ("train",)},
    **{"localize": ("train", "measured"), "evaluate": ("train",)},
}
"""The examples that each one needs."""
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
    "Model": (
        "localization.model.localizer_model",
        ("probabilities", "positions", "regions", "faults"),
    ),
    "Answers": ("localization.trust.answers", ("answered",)),
    "Evaluation": (
        "localization.evaluation.result",
        ("accuracy", "answered", "accuracy_of_answers", "calibration_error", "median_error"),
    ),
    "Reduced": ("simulator.models.reduced.reduced_model", ("solve", "at")),
    "Limit": ("simulator.limits.limit", ()),
    "Calibration": ("simulator.calibration.run", ("chi_squared", "rms_error", "strengths")),
    "GapFindings": ("localization.gap.gap_findings", ("summary", "write")),
    "Study": ("localization.study.study", ("best", "spacing", "write", "plot")),
    "InputError": ("simulator.sweeps.errors", ()),
    "ToleranceError": ("simulator.sweeps.errors", ()),
}
"""Module of each class that a user meets, and its members that the page explains."""
BUILT_BY_USERS = ("Sensor", "PointContacts", "DepthImage", "PressureImage")
"""Classes whose constructor a user calls."""
COLUMNS = ("type", "default", "shape", "unit", "meaning")
PAGES = {"xr.Dataset": "../files.md#sweeps", "contacts": "class-sensor.md#sensorstep"}


def page() -> str:
    """The index as the repository stores it, in Markdown: each name and its purpose."""
    return _index(lambda name: f"`{name}`")


def pages() -> dict[str, str]:
    """The pages of the site by their paths from the index: the index, and one for each name."""
    texts = {"api.md": _index(lambda name: f"[`{name}`](api/{_file(name)})")}
    for name in (*EXAMPLES, *CLASSES):
        lines = _function(name) if name in EXAMPLES else _class(name)
        texts[f"api/{_file(name)}"] = "\n".join(lines).rstrip() + "\n"
    return texts


def paths() -> dict[str, list[str]]:
    """The paths of the pages of names from the index, by group."""
    return {title: [f"api/{_file(name)}" for name in names] for title, names in GROUPS.items()}


def _file(name: str) -> str:
    """Name of the page of a name; some systems take `study.md` and `Study.md` for the same."""
    return f"class-{name.lower()}.md" if name in CLASSES else f"{name}.md"


def _index(link: Callable[[str], str]) -> str:
    lines = [HEAD]
    for title, names in GROUPS.items():
        objects = [_class_of(name) if name in CLASSES else getattr(rcskin, name) for name in names]
        rows = [(link(name), first(each)) for name, each in zip(names, objects, strict=True)]
        lines += [f"## {title}", "", *table(("name", "purpose"), rows)]
    return "\n".join(lines).rstrip() + "\n"


def _function(name: str) -> Iterator[str]:
    """What a function does, its arguments, its result, its errors and the example."""
    yield from _called(f"rcskin.{name}", f"rcskin.{name}", getattr(rcskin, name), "#")
    yield from ("## Example { data-search-exclude }", "", "```python", example(name), "```", "")


def example(name: str) -> str:
    """A program with the example of a function, after the examples that it needs."""
    needed = {name}
    for each in reversed(EXAMPLES):
        needed |= {*AFTER.get(each, ())} if each in needed else set()
    code = "\n".join(code for each, code in EXAMPLES.items() if each in needed)
    imports = ["import numpy as np"] if "np." in code else []
    return "\n".join([*imports, "import rcskin", "", code])


def _called(heading: str, name: str, function: Any, level: str) -> Iterator[str]:
    """A heading, the call, what it does, its arguments, its result and its errors."""
    signature = inspect.signature(function)
    text, meanings, errors = parts(function, list(signature.parameters))
    yield from (f"{level} {heading}", "", f"{first(function)} {text}".strip(), "")
    yield from ("```py", call(name, signature), "```", "")
    yield from _arguments(signature, meanings)
    result = str(signature.return_annotation).replace("Self", heading.partition(".")[0])
    if result != "None":
        yield from (f"Returns {linked(result, _link)}.", "")
    yield from errors_of(errors, _link)


def _arguments(signature: inspect.Signature, meanings: dict[str, str]) -> Iterator[str]:
    """A table of the arguments of a call."""
    rows = []
    for each in signature.parameters.values():
        if each.name != "self":
            default = "must be given" if each.default is each.empty else f"`{each.default!r}`"
            rows.append(_row(each.name, each.annotation, default, meanings.get(each.name, "")))
    if rows:
        yield from table(("argument", *COLUMNS), rows)


def _row(name: str, annotation: Any, default: str, text: str) -> tuple[str, ...]:
    meaning, shape, unit = described(text)
    shape = f"`{shape}`" if shape else ""
    return (f"`{name}`", linked(annotation, _link), default, shape, unit, meaning)


def _class(name: str) -> Iterator[str]:
    """A heading, what the class is, its constructor, its attributes and its methods."""
    kind, members = _class_of(name), CLASSES[name][1]
    signature = inspect.signature(kind) if name in BUILT_BY_USERS else inspect.Signature()
    annotations = getattr(kind, "__annotations__", {})
    text, meanings, errors = parts(kind, [*signature.parameters, *annotations, "times"])
    yield from (f"# class rcskin.{name}", "", f"{first(kind)} {text}".strip(), "")
    if signature.parameters:
        yield from ("```py", call(f"rcskin.{name}", signature), "```", "")
        yield from _arguments(signature, meanings)
    attributes = [
        _row(each, annotations.get(each, "float | None"), "", meaning)
        for each, meaning in meanings.items()
        if each not in signature.parameters
    ]
    properties = [each for each in members if not inspect.isfunction(getattr(kind, each))]
    attributes += [_property(each, getattr(kind, each)) for each in properties]
    if attributes:
        yield from table(("attribute", *COLUMNS), attributes)
    yield from errors_of(errors, _link)
    for each in (each for each in members if each not in properties):
        yield from _called(f"{name}.{each}", each, getattr(kind, each), "##")


def _property(name: str, member: property | cached_property) -> tuple[str, ...]:
    function: Any = member.func if isinstance(member, cached_property) else member.fget
    annotation = inspect.signature(function).return_annotation
    return _row(name, annotation, "", " ".join((inspect.getdoc(function) or "").split()))


def _link(name: str) -> str:
    """A name as code, with a link to its page from that of another name if it has one."""
    if name in EXAMPLES or name in CLASSES:
        return f"[`{name}`]({_file(name)})"
    return f"[`{name}`]({PAGES[name]})" if name in PAGES else f"`{name}`"


def _class_of(name: str) -> type:
    return getattr(import_module(f"rcskin.{CLASSES[name][0]}"), name)
