"""Sweeps of odd shapes, as files to export."""

import json
from functools import cache

import numpy as np
import pytest
from rcskin.simulator.dataset.exports.export import export
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import write
from rcskin.simulator.sweeps.reading_quantities import GAIN

CASES = ("simulated", "measured", "gains", "contacts", "one reading")
CONTACTS = {
    "contact_x": [[0.01, 0.02], [np.nan, np.nan], [0.03, np.nan]],
    "contact_y": [[0.02, 0.03], [np.nan, np.nan], [0.01, np.nan]],
    "contact_force": [[1.0, 0.5], [np.nan, np.nan], [2.0, np.nan]],
    "contact_area": [[1e-4, 2e-4], [np.nan, np.nan], [5e-5, np.nan]],
}
"""Two contacts, none, and one."""


@pytest.fixture(scope="session")
def sweeps_of(make_sweeps, make_scene):
    """A function that builds the sweeps of a case."""

    def build(case):
        if case == "simulated":  # two interfaces, one of which skips a frequency; three sessions
            sweeps = make_sweeps(
                7,
                taken=np.array([[True, True, False], [True, True, True]]),
                session=[3, 3, 3, 8, 8, 3, 3],
            )
            return sweeps.assign_attrs(
                model="reduced", rtol=1e-4, seed=5, sessions=json.dumps({3: "Händé 右"})
            )
        if case == "measured":  # times, a scene, and presses with a place
            scene = make_scene(interfaces={"meter": ["top-left", "bottom-left"]}, rows=2, columns=3)
            return make_sweeps(
                5,
                ("meter",),
                np.asarray(scene.frequencies),
                press=["none", "1,2:2.0", "1,1:2.0+2,3:1.5", "disc(0.02,0.03,0.01):2.0", "2,2"],
                row=[0, 1, -1, -1, 2],
                column=[0, 2, -1, -1, 2],
                session=[1, 1, 1, 2, 2],
                time=[1.7e9, 1.7e9 + 0.5, 1.7e9 + 1.1, 1.7e9 + 60, 1.7e9 + 60.5],
                attributes={"model": "measured", "scene": scene_text(scene)},
            )
        if case == "gains":  # gain and phase, and no labels
            return make_sweeps(
                4, ("node",), kind=GAIN, press=["unknown"] * 4, row=[-1] * 4, column=[-1] * 4
            )
        if case == "contacts":  # of a simulator that knows what touches the skin
            texts = ["disc(0.01,0.02,0.006):1N+disc(0.02,0.03,0.008):0.5N", "none"]
            sweeps = make_sweeps(
                3,
                press=[*texts, "disc(0.03,0.01,0.004):2N"],
                row=[-1, 0, -1],
                column=[-1, 0, -1],
            )
            return sweeps.assign(
                {name: (("sweep", "patch"), each) for name, each in CONTACTS.items()}
            )
        return make_sweeps(1, ("left",), np.array([1e3]))

    return build


@pytest.fixture(scope="session", params=CASES)
def sweeps(request, sweeps_of):
    """Sweeps of each case."""
    return sweeps_of(request.param)


@pytest.fixture(scope="session")
def data(sweeps, tmp_path_factory):
    """File of the sweeps."""
    path = tmp_path_factory.mktemp("sweeps") / "data.nc"
    write(sweeps, path)
    return path


@pytest.fixture(scope="session")
def exported(data, tmp_path_factory):
    """A function that exports the sweeps to a new path, once for each."""

    @cache
    def exported(name, format_=None):
        output = tmp_path_factory.mktemp("exported") / name
        export(data, output, format_)
        return output

    return exported
