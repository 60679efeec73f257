"""A source of another voltage is fitted, and other connections than stated are found and named."""

from pathlib import Path

import numpy as np
import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.report import explanations
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.parameters import parts_with
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import build

KNIT = Path(__file__).parents[4] / "shared" / "data" / "knit"
KEYS = 36
NOISE = 2e-3
READOUT = {"magnitude_noise": NOISE, "phase_noise": NOISE, "display_digits": 9}
TRUTH = {"sheet_resistance": 0.2, "capacitance": -0.3}
PRESSES = ("none", "1,2:26pF", "1,6:33pF", "1,11:29pF")


@pytest.fixture(scope="module")
def yarn():
    """The knitted pad with a third of its places and a sixth of its frequencies."""
    few = np.linspace(2e3, 25.75e3, 16).tolist()
    changes = {"pixels.columns": 12, "sweep.frequencies": few, "readout": READOUT}
    return load_scene("knit-36").with_(changes)


@pytest.fixture(scope="module")
def gains(yarn):
    """Of another yarn, read with noise, shape (press, interface, frequency)."""
    truth = parts_with(yarn.parts, TRUTH).scene
    read = simulate(
        Solver(truth.parts, 1e-5),
        [parse_press(each, 2.0, yarn.parts.skin, yarn.press) for each in PRESSES],
    )
    noise = NOISE * np.random.default_rng(0).standard_normal(read["gain"].shape)
    return read.assign(gain=(read["gain"].dims, read["gain"].values * (1 + noise)))


def fitted(*more, fix=("others",), **options):
    return Options(fit=(*TRUTH, *more), fix=fix, **options)


def lines(found, words):
    return [line for line in explanations(found) if words in line]


def assert_truth(found):
    assert found.chi_squared == pytest.approx(1, abs=0.35)
    for name, value in TRUTH.items():
        low, high = found.intervals[name]
        assert low < value < high


def test_the_voltage_of_the_source_is_fitted_with_a_standard_error(yarn, gains):
    found = calibrate(
        yarn, gains.assign(gain=0.56 * gains["gain"]), fitted("source_scale"), trials=False
    )
    assert_truth(found)
    assert found.identified["source_scale"]
    error = found.standard_errors["source_scale"]
    assert abs(found.values["source_scale"] - 0.56) < 3 * error < 0.01
    assert [each.source_scale for each in found.scene.interfaces] == pytest.approx([0.56] * 2, 0.01)
    assert lines(found, f"times the stated voltage, standard error {error:.2g}")


def test_the_voltage_of_the_source_is_a_parameter_of_gains_unless_it_is_fixed(yarn, gains):
    rest = gains.isel(sweep=[0])
    every = calibrate(yarn, rest, trials=False)
    assert "source_scale" in every.intervals
    known = calibrate(yarn, rest, Options(fix=("source_scale",)), trials=False)
    assert "source_scale" not in known.intervals


def test_a_voltage_that_the_gains_do_not_determine_is_reported_so(yarn, gains):
    """Far above the cut-off a gain is proportional to the source over sqrt(c / R) of the yarn."""
    high = yarn.with_({"sweep.frequencies": np.geomspace(3e6, 9e6, 8).tolist()})
    high = high.with_({f"interface.{k}.load.capacitance": 0.0 for k in (1, 2)})
    high = high.with_({"readout.magnitude_noise": 0.05})
    found = calibrate(
        high, simulate(Solver(high.parts, 1e-4), [Press()]), fitted("source_scale"), trials=False
    )
    assert not found.identified["source_scale"]
    assert lines(found, "voltage of the source is not identified by these gains")


def test_a_fixed_voltage_that_is_another_is_named(yarn, gains):
    found = calibrate(yarn, gains.assign(gain=0.56 * gains["gain"]), fitted(), trials=False)
    assert lines(found, "a source of 0.56 times the stated voltage would leave")


@pytest.mark.parametrize("scale", [1.0, 0.56])
def test_exchanged_ends_are_found_named_and_in_the_fitted_scene(yarn, gains, scale):
    other = gains.assign(gain=(gains["gain"].dims, scale * gains["gain"].values[:, ::-1]))
    found = calibrate(yarn, other, fitted("source_scale"), trials=False)
    assert_truth(found)
    (line,) = lines(found, "the stated connection fails")
    assert "taken: interfaces left and right exchanged, which leaves" in line
    ends = {each.name: (each.high, each.driven_with) for each in found.scene.interfaces}
    assert ends == {"left": (("right",), ("right",)), "right": (("left",), ("left",))}


def test_keys_that_are_counted_from_the_other_end_are_found(yarn, gains):
    """Of a pad that is read at one end only, ends and keys cannot be told apart."""
    one = yarn.with_({"interface": [_alone(yarn, 0)]})
    mirrored = ("none", "1,11:26pF", "1,7:33pF", "1,2:29pF")
    presses = [parse_press(each, 2.0, one.parts.skin, one.press) for each in mirrored]
    read = simulate(Solver(parts_with(one.parts, TRUTH), 1e-5), presses)
    read["press"] = ("sweep", np.array(PRESSES, dtype=object))
    found = calibrate(one, read, fitted(), trials=False)
    assert lines(found, "taken: columns counted from the other end, which leaves")
    for name, value in TRUTH.items():
        assert found.values[name] == pytest.approx(value, abs=0.01)


def _alone(scene, k):
    """An interface that is driven alone, as in a file."""
    own = scene.interfaces[k].model_dump(exclude_none=True)
    return {**own, "driven_with": [], "low": "earth"}


@pytest.fixture(scope="module")
def crossed(make_scene):
    """Two sheets fed along a short edge or along a long one, read one at a time."""
    apart = {"span": [0.2, 0.9]}
    names = ("top-left", "bottom-left", "top-bottom", "bottom-bottom")
    wires = {"short": ("top-left", "bottom-left"), "long": ("top-bottom", "bottom-bottom")}
    scene = make_scene(
        dict.fromkeys(names, apart),
        wires,
        length=0.2,
        width=0.05,
        columns=4,
        frequencies=np.geomspace(2e3, 2e5, 8),
    )
    gain = {"reader": "gain", "series_resistance": 1e5}
    keys = {f"interface.{name}.{key}": value for name in wires for key, value in gain.items()}
    return scene.with_({**keys, "readout": READOUT, "press.factor_spread": 0.0})


def test_an_interface_that_is_another_of_the_scene_is_named(crossed):
    truth = parts_with(crossed.parts, {"capacitance": -0.3}).scene
    read = simulate(Solver(truth.parts, 1e-5), [Press(), parse_press("1,2:2", 2.0)])
    short = read.sel(interface=["long"]).assign_coords(interface=["short"])
    found = calibrate(crossed, short, Options(fit=("capacitance",), fix=("others",)), trials=False)
    assert lines(found, "taken: interface short is long of the scene, which leaves")
    assert found.values["capacitance"] == pytest.approx(-0.3, abs=0.01)
    (only,) = found.fit.spec.measurements.parts.setup.interfaces
    assert (only.name, only.high) == ("short", ("top-bottom",))


def test_a_misfit_of_another_cause_exchanges_nothing(crossed):
    truth = crossed.with_({"skin.foam.loss_tangent": 0.2})
    read = simulate(Solver(truth.parts, 1e-5), [Press(), parse_press("1,2:2", 2.0)])
    found = calibrate(crossed, read, Options(fit=("capacitance",), fix=("others",)), trials=False)
    assert found.chi_squared > 2
    assert not lines(found, "taken:")
    assert found.scene.interfaces == crossed.interfaces


def knit_gains():
    """Gains of the knitted pad untouched, and of the touch of each key where it is strongest."""
    files = [KNIT / f"participant001_trial001_button{key:03}.txt" for key in range(KEYS + 1)]
    if not all(each.is_file() for each in files):
        pytest.skip(f"{KNIT} has no files of Resources/p001/trial001 of CTS_Interactive_Examples")
    for key, file in enumerate(files):
        raw = file.read_bytes()
        _, channels, frequencies, samples = np.frombuffer(raw[:16], "<i4")
        read = np.frombuffer(raw[16:], "<f4").reshape(samples, channels, frequencies)
        size = read[:, :, 40:60].mean(axis=(1, 2))
        yield np.median(read[size < 1.1 * np.quantile(size, 0.1)] if key else read, axis=0)


def test_a_measured_knitted_pad_is_fitted_as_it_comes():
    """Its ends are exchanged and its source is another: 1.7 % at rest and 2.4 % touched by hand."""
    scene, some = load_scene("knit-36"), (0, 4, 12, 20, 28, 36)
    every = list(knit_gains())
    sweeps = build(
        np.stack([every[key] for key in some]).astype(complex),
        scene.frequencies,
        interface=["left", "right"],
        press=["none", *(f"1,{key}" for key in some[1:])],
        row=[0] + [1] * (len(some) - 1),
        column=list(some),
        session=[0] * len(some),
        kind=scene.parts.setup.kind,
    ).dataset()
    found = calibrate(scene, sweeps, trials=False)
    assert lines(found, "taken: interfaces left and right exchanged")
    assert found.values["source_scale"] == pytest.approx(0.56, abs=0.03)
    assert found.rms_error < 0.024
