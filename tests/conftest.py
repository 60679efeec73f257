"""Scenes and presses for tests: built from a few keywords, or drawn at random."""

import itertools
import math
import os
import shutil
import sys
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import strategies as st
from pydantic import ValidationError
from rcskin import __main__ as rcskin
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.sweeps import output_files
from rcskin.tests.library.scenes import build_scene

EDGES = ("left", "right", "bottom", "top")
WHOLE = [(0.0, 1.0)]
LAYOUTS = [WHOLE, [(0.2, 0.7)], [(0.5, 1.0)], [(0.0, 0.3), (0.6, 1.0)], [(0.0, 0.5), (0.5, 1.0)]]
"""Spans of the foils that share one edge; those of the last one touch."""
RESISTANCES = (0.0, 0.0, 1.0, 300.0)
"""Of contacts, ohm m."""
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


def logarithmic(low, high):
    """Positive numbers of all magnitudes between two."""
    return st.floats(math.log10(low), math.log10(high)).map(lambda exponent: 10**exponent)


@st.composite
def skins(draw):
    """Keywords of `build_scene` for a skin and its pixels."""
    return {
        "length": draw(st.floats(0.02, 0.2)),
        "width": draw(st.floats(0.02, 0.2)),
        "top": draw(logarithmic(1e3, 1e6)),
        "bottom": draw(logarithmic(1e3, 1e6)),
        "c": draw(logarithmic(1e-9, 1e-8)),
        "rows": draw(st.integers(1, 3)),
        "columns": draw(st.integers(1, 3)),
    }


@st.composite
def foils(draw, layouts=LAYOUTS, resistances=RESISTANCES):
    """(edge and number, further keys) of the foils on one sheet; resistances in ohm m."""
    edges = draw(st.lists(st.sampled_from(EDGES), unique=True, min_size=1, max_size=2))
    return {
        f"{edge}-{number}": {"span": span, "resistance": draw(st.sampled_from(resistances))}
        for edge in edges
        for number, span in enumerate(draw(st.sampled_from(layouts)))
    }


def _some(draw, names):
    return draw(st.lists(st.sampled_from(sorted(names)), unique=True, min_size=1))


@st.composite
def scenes_between(draw, layouts=LAYOUTS, resistances=RESISTANCES):
    """Any foils; the meter between some of the top sheet's and some of the bottom sheet's."""
    any_foils = foils(layouts, resistances)
    tops = {f"top-{name}": more for name, more in draw(any_foils).items()}
    bottoms = {f"bottom-{name}": more for name, more in draw(any_foils).items()}
    interfaces = {"meter": (_some(draw, tops), _some(draw, bottoms))}
    return build_scene({**tops, **bottoms}, interfaces, **draw(skins()))


@st.composite
def scenes_across(draw):
    """Any foils; the meter between any of them, so that direct current may flow."""
    contacts = {f"top-{name}": more for name, more in draw(foils()).items()}
    if draw(st.booleans()):
        contacts |= {f"bottom-{name}": more for name, more in draw(foils()).items()}
    names = sorted(contacts)
    high = _some(draw, names)
    low = [name for name in names if name not in high and draw(st.booleans())]
    try:
        return build_scene(contacts, {"meter": (high, low)}, **draw(skins()))
    except ValidationError:
        return None


@st.composite
def scenes_in_pairs(draw):
    """Both sheets with the same foils, driven in pairs at one or two interfaces."""
    pairs, skin = draw(foils()), draw(skins())
    ratio = skin["bottom"] / skin["top"]
    contacts = {f"top-{name}": more for name, more in pairs.items()}
    contacts |= {
        f"bottom-{name}": {**more, "resistance": ratio * more["resistance"]}
        for name, more in pairs.items()
    }
    interfaces = {
        number: [[f"{sheet}-{name}" for name in driven] for sheet in ("top", "bottom")]
        for number, driven in zip("12", [_some(draw, pairs), _some(draw, pairs)], strict=True)
    }
    return build_scene(contacts, interfaces, **skin)


@st.composite
def presses(draw, scene):
    """Touches of any strength on up to four pixels."""
    pixels = [*itertools.product(range(scene.pixels.rows), range(scene.pixels.columns))]
    pressed = draw(st.lists(st.sampled_from(pixels), unique=True, max_size=4))
    return Press(tuple(Touch(i + 1, j + 1, draw(st.floats(0.3, 10))) for i, j in sorted(pressed)))


@pytest.fixture(scope="session", autouse=True)
def own_state(tmp_path_factory):
    """What rcskin keeps of virtual meters stays out of the user's own folder."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("XDG_STATE_HOME", "LOCALAPPDATA"):
            patch.setenv(name, str(tmp_path_factory.mktemp("state")))
        yield


@pytest.fixture(scope="session")
def library(tmp_path_factory):
    """Scenes and trained models that all processes of a run share."""
    from rcskin.tests.library.models import Library

    folder = tmp_path_factory.getbasetemp()
    return Library((folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder) / "library")


@pytest.fixture
def replacing():
    """In the test every file may be replaced."""
    with output_files.replacing(measured=True):
        yield


@pytest.fixture(scope="session")
def moved():
    """Values of a scene's parameters, each away from where the scene has it."""
    return {
        "sheet_resistance": 0.3,
        "sheet_mismatch": -0.4,
        "capacitance": 0.2,
        "contact_resistance": 0.5,
        "loss_tangent": 0.03,
        "phase_exponent": 0.94,
        "lead_resistance": 50.0,
        "lead_inductance": 1e-3,
        "stray_capacitance": 4e-12,
    }


@pytest.fixture(scope="session")
def make_scene():
    """A function that builds a scene from a few keywords."""
    return build_scene


@pytest.fixture
def run(monkeypatch, capsys):
    """Runs `rcskin ARGUMENTS`; gives the exit code, standard output and standard error."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["rcskin", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            rcskin.main()
        return ended.value.code, *capsys.readouterr()

    return run


@pytest.fixture
def refused(run):
    """Runs `rcskin ARGUMENTS`, which must end by code 2 and one line; gives that line."""

    def refused(*arguments):
        code, out, err = run(*arguments)
        assert (code, out, err.count("\n")) == (2, "", 1) and err.startswith("rcskin: "), err
        return err

    return refused


@pytest.fixture(scope="session")
def earth_alone():
    """A function of standard error: whether it warns once of missing surroundings, no more.

    Commands on measured skins do where their scene has no surroundings.
    """

    def alone(err):
        return (
            err.count("\n") == 1 and ": the scene has no [surroundings]: a metal body behind" in err
        )

    return alone


@pytest.fixture(scope="session")
def random():
    """Hypothesis strategies of scenes and presses."""
    return SimpleNamespace(
        between=scenes_between,
        across=lambda: scenes_across().filter(lambda scene: scene is not None),
        in_pairs=scenes_in_pairs,
        presses=presses,
        logarithmic=logarithmic,
    )


@pytest.fixture(scope="module")
def chromium():
    """A browser to open pages in; Playwright's event loop in this thread ends with the module."""
    playwright = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        pytest.skip("there is no Chromium to open the page in")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def unpainted(monkeypatch):
    """Charts are drawn and their files written, but not painted: pixels take most of the time."""

    def write(figure, path, **_):
        Path(path).write_text("unpainted")

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", write)


@pytest.fixture
def short_studies(monkeypatch):
    """Points of a study are of few sweeps, where one process finds them."""
    monkeypatch.setattr("rcskin.localization.study.point.SWEEPS", 400)


@pytest.fixture
def undrawn(monkeypatch):
    """Tables and summaries without their charts, which take half of the time."""
    for name in ("draw_maps", "draw_distances"):
        monkeypatch.setattr(f"rcskin.simulator.limits.survey_results.{name}", lambda *given: None)


@pytest.fixture
def linear_intervals(monkeypatch):
    """Intervals of calibrations are linear, not of profiles, which take half of the time."""
    linear = "rcskin.simulator.calibration.distributions.Profile.linear"
    monkeypatch.setattr(linear, lambda *given: True)


@pytest.fixture
def coarse(monkeypatch):
    """Limits are of readings told to a percent, by models that are soon trained."""
    monkeypatch.setattr("rcskin.simulator.bounds.touch_readings.RTOL", 1e-2)


@pytest.fixture
def windows(monkeypatch, pytestconfig):
    """Windows as far as it can be imitated; see `systems/`."""
    if pytestconfig.getoption("system") != "windows":
        monkeypatch.syspath_prepend(Path(__file__).with_name("systems"))
        import_module("imitated").take_away("windows", monkeypatch)
