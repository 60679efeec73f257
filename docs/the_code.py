"""The page of the code: a picture of the packages, and where each subject has its law."""

from __future__ import annotations

import html
import re
import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "explanation" / "rooms.md"
PICTURE = ROOT / "docs" / "assets" / "code.svg"
PACKAGES = ("simulator", "localization", "hardware")
HEAD = """# The code

![Packages by level: hardware uses localization, and both use the simulator](../assets/code.svg)

A package may import what stands below it in its column, and nothing beside or above it;
`hardware` may use `localization`, and both may use `simulator`. `lint-imports` checks this by the
contracts of `pyproject.toml`. Everything is installed under the one name `rcskin`.

Find the row of what you look for, and open its file. Tests stand at the same path below `tests/`;
`tests/physics` states the laws, `tests/skins` runs one contract over every kind of skin.
`python docs/generate.py` writes this page, and finds the files by the names.
"""
SUBJECTS: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "What a scene is": {
        "the scene file: keys, checks that span tables": ("Scene", "Table"),
        "what computations take: skin, setup, meter, plan of presses": ("SceneParts",),
        "foils, wiring, interfaces: what is driven, what is solved, what is read": ("Setup",),
        "foam: permittivity, stress and strain": ("Mechanics", "Elastomer"),
        "foam in time: creep, temperature, humidity": ("Relaxation", "Creep"),
        "frequency: s of a loss tangent, a constant phase and a leak": ("laplace_variable",),
        "surroundings: earth, bodies, rim, cover": ("Surroundings", "SurroundingsMatrix"),
        "spread of skins over sessions, of presses over sweeps": ("Session", "DrawnPress"),
    },
    "A press": {
        "a press as text, its touches and strengths": ("parse_press", "Press"),
        "the cells that a touch covers, and the rise of their capacitance": (
            "TouchBatch",
            "TouchedCells",
        ),
        "a touch by depth or by force: the foam and the applicator in equilibrium": (
            "deformation",
            "equilibrium",
        ),
        "fingers, and walls at the edges of a press": ("finger_of", "Walls"),
    },
    "Models": {
        "the choice of a model that keeps the tolerance": ("Solver",),
        "uniform skins: the exact line": ("Line",),
        "elements: matrices K and M, circuits": ("System", "Circuit"),
        "the estimate of the error of Rs and Cp": ("relative_difference", "estimated_error"),
        "skins that vary, stretch or bend: their weak form": ("PressedSystem", "Materials"),
        "reduced models: the training": ("reduce", "GreedyBasis"),
        "the error of a reduced model: its certificate": ("certificates",),
        "the small system: K = 1, M of low rank; all terminals": ("Skins", "UnpressedNetwork"),
        "parameters that are fitted, drawn or designed": ("Variation",),
    },
    "Readings and sweeps": {
        "the sign of X, Rs and Cp of an impedance": ("Quantity", "branch_reactance"),
        "the schema of sweeps, and their checks": ("build",),
        "import of other files: columns, units, labels": ("import_file",),
        "laws that a passive network cannot break": ("examine", "fit_passive"),
        "the errors of a reading: noise, session, digits": ("MeterSession", "ErrorModel"),
        "a reader of all frequencies at once": ("Multisine",),
        "the skin drawn for a session": ("drawn_skin",),
    },
    "Uses": {
        "data sets: plan, blocks, the same bytes again": ("DatasetPlan", "generate"),
        "calibration: prior, fit, intervals": ("calibrate", "LeastSquaresProblem"),
        "limits: what no localizer can exceed": ("Likelihood", "bayes"),
        "design: search and scores": ("TrainedSkins",),
        "a mounted skin in time, in a robot's engine": ("Sensor", "MujocoSkin"),
        "gradients in PyTorch": ("SkinModule",),
    },
    "Localization": {
        "features, and the unpressed skin that they are compared with": ("Features", "Baselines"),
        "estimators, and their registry": ("Estimator",),
        "localizers that invert the simulator": ("ModelBased", "SequentialPosterior"),
        "when no answer is given: novel sweeps, calibrated probabilities": ("Guards", "decide"),
        "a trained localizer and its file": ("localization.Model", "localization.Part"),
        "touches over time; the next reading": ("Follower", "AdaptivePolicy"),
    },
    "Meters": {
        "a command and its answer: time limit, an answer that comes late": ("Conversation",),
        "the retry of a reading that failed or is not sound": ("MachineOperator", "measure_sweep"),
        "settings: set, read back, restored": ("Setting", "OriginalSettingsStore"),
        "recording: order of presses, journal, resumption": ("RecordingRun", "RecordingJournal"),
        "checks of a sweep while it is measured": ("SweepChecker",),
        "live answers": ("LiveSession",),
    },
}
"""Subjects by theme, with the names of the classes and functions where their laws begin."""
WIDTHS = {"simulator": 450, "localization": 230, "hardware": 330}
LINE, MARGIN = 26, 14


def page() -> str:
    """The whole page, in Markdown."""
    parts = [HEAD]
    for theme, subjects in SUBJECTS.items():
        rows = [f"| {subject} | {_places(names)} |" for subject, names in subjects.items()]
        parts.append(
            "\n".join([f"## {theme}", "", "| look for | begin at |", "| --- | --- |", *rows])
        )
    return "\n\n".join(part.rstrip() for part in parts) + "\n"


def _places(names: tuple[str, ...]) -> str:
    files: dict[str, list[str]] = {}
    for name in names:
        files.setdefault(place_of(name), []).append(f"`{name.rpartition('.')[2]}`")
    return "; ".join(f"`{file}`: {', '.join(own)}" for file, own in files.items())


def place_of(name: str) -> str:
    """The file of a public class or function, by its name or by PACKAGE.NAME.

    The first of several by path. Raises KeyError where there is none.
    """
    if name not in _defined():
        raise KeyError(f"no class or function {name}: name its successor in SUBJECTS of {__file__}")
    return _defined()[name]


@cache
def _defined() -> Mapping[str, str]:
    found: dict[str, str] = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            text = path.read_text(encoding="utf-8")
            for name in re.findall(r"^(?:class|def) ([A-Za-z]\w*)", text, re.MULTILINE):
                for known_as in (name, f"{package}.{name}"):
                    found.setdefault(known_as, path.relative_to(ROOT).as_posix())
    return found


def picture() -> str:
    """The packages by level as SVG, made from the import contracts."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    contracts = tomllib.loads(text)["tool"]["importlinter"]["contracts"]
    layers = {
        container.removeprefix("rcskin."): each["layers"]
        for each in contracts
        for container in each.get("containers", ())
    }
    height = LINE * (1 + max(len(layers[name]) for name in PACKAGES)) + 3 * MARGIN
    parts, left = [], MARGIN
    for name in reversed(PACKAGES):
        parts += _column(name, layers[name], left, height)
        left += WIDTHS[name] + MARGIN
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {left} {height}" '
            'font-family="sans-serif" font-size="12" text-anchor="middle">',
            f'<rect width="{left}" height="{height}" fill="white"/>',
            *parts,
            "</svg>",
            "",
        ]
    )


def _column(package: str, layers: list[str], left: int, height: int) -> Iterator[str]:
    """A package: its levels from the top down, the lowest at the bottom."""
    width = WIDTHS[package]
    middle, top = left + width / 2, height - MARGIN - LINE * len(layers)
    yield f'<text x="{middle:g}" y="{top - 10}" font-size="14" font-weight="bold">{package}</text>'
    for number, layer in enumerate(layers):
        y = top + LINE * number
        names = html.escape(" · ".join(each.strip() for each in layer.split("|")))
        size = min(12.0, 1.9 * width / len(names))
        yield (
            f'<rect x="{left}" y="{y}" width="{width}" height="{LINE - 4}" rx="3" '
            'fill="#e8eef4" stroke="#0072B2"/>'
        )
        yield f'<text x="{middle:g}" y="{y + 15}" font-size="{size:.1f}">{names}</text>'
