"""A strip with one pair of foils, and a meter with large errors."""

import pytest
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.scene_files import scene_text

NOISE = {"magnitude_noise": 0.02, "phase_noise": 0.02}


@pytest.fixture(scope="session")
def strip(make_scene):
    """A function that builds one of few pixels; session: what skins of [dataset.session] have."""

    def build(readout=NOISE, session=None, **more):
        given = {"width": 0.02, "columns": 4, "bottom": 50e3, "frequencies": (1e3, 1e4)} | more
        scene = make_scene(**given)
        scene = scene.model_copy(update={"readout": Readout(**readout)})
        even = {"unevenness": 0.0, "sheet_mismatch": 1.0} | (session or {})
        return scene.with_({"press.factor_spread": 0.1, "dataset.session": even})

    return build


@pytest.fixture
def strip_file(strip, tmp_path):
    """That strip as a file."""
    path = tmp_path / "strip.toml"
    path.write_text(scene_text(strip()), encoding="utf-8")
    return path
