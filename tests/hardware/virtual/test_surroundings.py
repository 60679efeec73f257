"""The virtual meter's low terminal is a virtual earth, and a finger may touch its skin."""

import numpy as np
import pytest
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.virtual.served_skin import instrument, simulated
from rcskin.simulator.scene.scene_files import load_scene

C_E = 1e-9
"""F/m², of a body behind the bottom sheet."""


@pytest.fixture(scope="module")
def earthed():
    """A strip before a body, of so little RC that 1 kHz is nearly none, read without error."""
    around = {
        "body": {"capacitance_per_area": C_E},
        "cover": {"thickness": 1e-3, "relative_permittivity": 3.0},
    }
    return load_scene("strip-1x3").with_(
        {
            "surroundings": around,
            "skin.sheet_resistance": 50e3,
            "sweep.frequencies": [1e3],
            "readout": {},
        }
    )


def test_a_skin_is_served_before_earth_and_touched_by_fingers(earthed, serve, command):
    """The closed forms of three conductors as the frequency falls to 0, over both ports."""
    meter = instrument(simulated(earthed.parts), pace=0.0)
    skin = earthed.skin
    (L, W), c, R = skin.sides, skin.foam.unpressed_capacitance_per_area, skin.top.sheet_resistance
    Rs = {}
    with serve(meter) as ports, open_meter(ports.resource, 5.0) as driver:
        for press in ("none", "1,2:touch", "1,2:rod", "1,2:finger", "none"):
            pressed = command("press", press, "--control", f"127.0.0.1:{ports.control}")
            assert pressed.exit_code == 0
            Rs[press] = driver.read_at(1e3).value.real
    assert Rs["none"] == pytest.approx(L / (3 * W) * (R + R * (1 + C_E / c)), rel=1e-4)
    finger = 8.8541878128e-12 * 3.0 / 1e-3 * L * W / 3
    x = np.linspace(L / 3, 2 * L / 3, 1001)
    by_touch = (
        R / W * finger * c * W * np.trapezoid(L * x - x**2 / 2, x) / (L / 3) / (c * W * L) ** 2
    )
    assert Rs["1,2:touch"] - Rs["none"] == pytest.approx(by_touch, rel=1e-3)
    assert Rs["1,2:finger"] > Rs["1,2:rod"] + 0.5 * by_touch


@pytest.mark.parametrize(
    ("press", "told"),
    [
        ("1,2:touch:rod:2", "must be ROW,COLUMN"),
        ("1,9:touch", "column must be in 1..3"),
        ("1,2:5.3nV", "FACTOR must be finite and > 0"),
    ],
)
def test_what_a_finger_cannot_do_is_said_in_one_line(earthed, serve, command, press, told):
    meter = instrument(simulated(earthed.parts), pace=0.0)
    with serve(meter) as ports:
        refused = command("press", press, "--control", f"127.0.0.1:{ports.control}")
    assert refused.exception and told in str(refused.exception)
    assert meter.press == "none"
