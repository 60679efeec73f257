"""Errors by data sheets and by measured spreads: formulas, known examples, and refusals.

A scene may name its meter, and is told of where it has none. Noise of readers of gains, in volts
and in bits, against samples of a converter.
"""

import math

import numpy as np
import pytest
from rcskin.simulator.measure.readout import MeterSession, flattened
from rcskin.simulator.measure.simulate import reading_error, simulate
from rcskin.simulator.meters.accuracy_table import ReadingConditions, read_table
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.meter import Readout, meter_names
from rcskin.simulator.scene.meter_tables import Converter
from rcskin.simulator.scene.scene_files import builtin_names, load_scene, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError
from rcskin.tests.refusals import refusal_of

SCENE = load_scene("strip-1x3")
BOARD = {  # Hz, ohm, spread of |Z| in %, spread of phase in degrees
    1e5: (0.49e6, 0.27, 0.03),
    1e4: (5.2e6, 0.28, 0.06),
    1e3: (51e6, 0.34, 0.92),
    120.0: (417e6, 1.3, 1.1),
    100.0: (517e6, 2.1, None),
}
"""32 readings of one board by a hand meter, B&K 880, from Dataset-5 of the High-Rate SHM working
group (CC BY-SA 4.0): upper bounds, because the board was shocked in between."""
SPREAD = {
    "impedance": [0.49e6, 5.2e6, 51e6, 417e6, 517e6],
    "frequency": [1e3],
    "magnitude": [[2.7e-3], [2.8e-3], [3.4e-3], [1.3e-2], [2.1e-2]],
    "phase": [[5e-4], [1e-3], [1.6e-2], [1.9e-2], [1.9e-2]],
}


def readout(named):
    return SCENE.with_({"readout": named}).readout


def of_board(readout):
    """Noise of |Z| over the spread on the board, lowest impedance first."""
    f = np.array([*BOARD])
    Z, measured, _ = (np.array(each, dtype=float) for each in zip(*BOARD.values(), strict=True))
    return readout.noise((-1j * Z)[None], f)[0, 0] / (measured / 100)


def test_the_keysights_bound_is_that_of_its_worked_example():
    """Data sheet, p. 11: 100 nF at 1 kHz and 1 V has Ae = 0.05 %; 1.68 mohm, 0.72 nS."""
    bound = readout("E4980A").accuracy(np.array([[1590.0 + 0j]]), np.array([1e3])) * math.sqrt(3)
    assert 100 * bound.item(0) == pytest.approx(0.05 + 0.168 / 1590 + 72e-9 * 1590, rel=1e-3)
    assert round(100 * bound.item(0), 2) == 0.05
    assert bound.item(1) == bound.item(0)


def test_accuracy_by_range_is_the_bound_of_the_virtual_meter_over_root_3():
    table, own = read_table(), readout("3522-50-derived")
    f = np.array([120.0, 5e3, 15e3, 2e5])
    Z = np.random.default_rng(1).choice([1.0, 1 - 2j, -1j], (6, 4)) * np.geomspace(
        20, 5e7, 24
    ).reshape(6, 4)
    found = own.accuracy(Z, f)
    for k, z in np.ndenumerate(Z):
        at = ReadingConditions(float(f[k[1]]), table.fitting_range(complex(z)), "MEDIUM", cable=1)
        expected = np.array(table.error_bounds(complex(z), at)) / math.sqrt(3)
        np.testing.assert_allclose(found[(slice(None), *k)], expected, rtol=1e-12)
    np.testing.assert_array_equal(own.noise(Z, f), found)
    assert own.smallest_noise <= found.min()


def test_which_model_fits_the_spreads_of_a_hand_meter():
    np.testing.assert_allclose(of_board(Readout(spread=SPREAD)), 1, rtol=1e-9)
    flat = of_board(readout("IM3523"))
    np.testing.assert_allclose(flat[:3], 1, atol=0.15)
    assert (flat[3:] < 0.25).all()
    by_range = of_board(readout("3522-50-derived"))
    assert (1.4 < by_range).all() and (by_range[1:] < 2.3).all() and by_range[0] > 10
    by_offset = of_board(readout("E4980A"))
    assert (by_offset[:2] < 1).all() and (by_offset[2:] > 6).all()


def test_spreads_are_interpolated_in_logarithms_and_end_at_the_grid():
    table = {"impedance": [1e3, 1e5], "frequency": [1e2, 1e4], "phase": [[1e-3, 1e-3]] * 2}
    own = Readout(spread={**table, "magnitude": [[1e-4, 1e-3], [1e-2, 1e-1]]}, phase_accuracy=0.1)
    Z = np.array([[1e3, 1e3, 1e3], [1e4, 1e4, 1e4], [1e9, 1e9, 1e9]]) * np.exp(-1j)
    magnitude, phase = own.noise(Z, np.array([1.0, 1e3, 1e9]))
    rows = [[1e-4, 10**-3.5, 1e-3], [1e-3, 10**-2.5, 1e-2], [1e-2, 10**-1.5, 1e-1]]
    np.testing.assert_allclose(magnitude, rows)
    np.testing.assert_allclose(phase, 1e-3)
    assert own.smallest_noise == 1e-4
    np.testing.assert_array_equal(own.accuracy(Z, np.ones(3))[1], 0.1)


@pytest.mark.parametrize("name", meter_names())
def test_a_press_that_halves_the_impedance_changes_the_noise_by_its_square_at_most(name):
    """Statistics take the noise of the unpressed skin, see `ErrorModel`."""
    f = SCENE.frequencies
    Z = -1j * np.geomspace(1e4, 1e7, 50)[:, None] * np.ones(len(f))
    ratio = readout(name).noise(Z / 2, f) / readout(name).noise(Z, f)
    assert 0.45 < ratio.min() and ratio.max() < 2.3


def test_a_readout_by_tables_is_one_of_four_numbers_on_average():
    sweeps = simulate(Solver(SCENE.parts), [Press()] * 2)
    table, flat = SCENE.with_({"readout": "E4980A"}), readout("IM3523")
    found = reading_error(table.parts.meter, sweeps)
    assert found.magnitude.shape == (sweeps.sizes["frequency"],)
    Z = np.full((3, 1, 2), 1e4 - 1e4j)
    own = flattened(table.readout, Z, np.array([1e3, 1e4]))
    assert own.uniform and own.magnitude_noise == pytest.approx(5.5e-4 / math.sqrt(3), rel=0.1)
    assert flattened(flat, Z, np.array([1e3, 1e4])) is flat


@pytest.mark.parametrize("name", meter_names())
def test_a_scene_with_tables_is_written_and_read_again(name):
    scene = SCENE.with_({"readout": name})
    again = parse_scene(scene_text(scene), "again")
    assert again == scene and hash(again) == hash(scene)
    assert not {"data_sheet", "spread"} & {*SCENE.readout.model_dump()}


@pytest.mark.parametrize(
    ("changed", "refusal"),
    [
        (
            {"data_sheet": {"accuracy": "E4980"}},
            "must be a table or one of 3522-50-derived, E4980A",
        ),
        ({"data_sheet": {"accuracy": "E4980A", "speed": "FAST"}}, "`speed` is for accuracies by"),
        (
            {"data_sheet": {"accuracy": "E4980A"}, "magnitude_noise": 1e-3},
            "`magnitude_noise` and `data_sheet` state the same error",
        ),
        ({"spread": SPREAD, "phase_noise": 1e-3}, "`phase_noise` and `spread` state the same"),
        ({"spread": {**SPREAD, "impedance": SPREAD["impedance"][::-1]}}, "`impedance` must ascend"),
        ({"spread": {**SPREAD, "phase": SPREAD["phase"][1:]}}, "`phase` must have 5 rows of 1"),
        ({"spread": {**SPREAD, "magnitude": [[0.0]] * 5}}, "`magnitude` must be > 0 and <= 1"),
        ({"spread": {**SPREAD, "magnitude": [[math.nan]] * 5}}, "`magnitude` must be > 0 and <= 1"),
    ],
)
def test_tables_that_state_no_error_are_refused(changed, refusal):
    assert refusal in refusal_of(SCENE.with_, {"readout": changed})


def test_readers_of_gains_take_no_errors_of_impedances():
    gains = {"interface.1.reader": "gain", "interface.1.series_resistance": 1e5}
    scene = SCENE.with_(gains)
    with pytest.raises(InputError, match="`readout.data_sheet` is of impedances"):
        scene.with_({"readout": "E4980A"})


@pytest.mark.parametrize(
    ("edges", "refusal"),
    [([20.0, 10.0], "starts must ascend"), ([20.0, 2e3], "starts must ascend")],
)
def test_offsets_that_do_not_ascend_are_refused(edges, refusal):
    band = [{"start": f, "basic": 0.1, "short_offset": 0, "open_offset": 0} for f in edges]
    with pytest.raises(InputError, match=refusal):
        SCENE.with_(
            {"readout": {"data_sheet": {"accuracy": {"name": "x", "stop": 1e3, "band": band}}}}
        )


OF_THE_PAPER = [name for name in builtin_names() if name.startswith(("sheet", "strip"))]


def scene_with(readout):
    text = scene_text(load_scene("strip-1x3").model_copy(update={"readout": Readout()}))
    head, _, tail = text.partition("[readout]")
    _, _, tail = tail.partition("\n\n")
    return parse_scene(f"{readout}\n{head}{tail}", "mine.toml")


@pytest.mark.parametrize("name", OF_THE_PAPER)
def test_the_papers_devices_are_read_by_its_meter(name):
    assert scene_with('readout = "IM3523"').readout == load_scene(name).readout


def test_a_named_meter_is_written_out_in_numbers():
    scene = scene_with('readout = "IM3523"')
    assert not scene.readout.exact
    assert parse_scene(scene_text(scene), "again") == scene


def test_a_scene_without_readout_reads_without_error():
    assert scene_with("").readout.exact
    assert not scene_with("readout = {phase_noise = 1e-3}").readout.exact


def test_another_meter_is_refused_with_those_there_are():
    assert meter_names() == ["3522-50-derived", "E4980A", "IM3523"]
    with pytest.raises(InputError, match="one of 3522-50-derived, E4980A, IM3523, got .IM35."):
        scene_with('readout = "IM35"')


GAIN = {"interface.1.reader": "gain", "interface.1.series_resistance": 1e6}
STRIP = load_scene("strip-1x5")
VOLTS = {"source_amplitude": 1.0, "noise": 2e-3, "samples": 64}
BITS = {"source_amplitude": 1.0, "bits": 8, "full_scale": 2.5, "samples": 64}


@pytest.mark.parametrize("given", [VOLTS, {**BITS, "noise": 5e-3}])
def test_the_noise_is_that_of_sampled_voltages(given):
    """Samples of a period, with noise and rounded to steps; phase and offset are random."""
    random, count = np.random.default_rng(1), 4000
    gain = 0.4 * np.exp(2j * np.pi * random.random((count, 1)))
    converter = Converter(**given)
    turn = 2 * np.pi * np.arange(converter.samples) / converter.samples
    V = converter.source_amplitude * np.abs(gain) * np.cos(turn + np.angle(gain))
    V = V + random.uniform(0, 0.5, (count, 1))
    V = V + converter.noise * random.standard_normal(V.shape)
    if converter.bits is not None:
        step = converter.full_scale / 2**converter.bits
        V = step * np.round(V / step)
    found = 2 / converter.samples * (V @ np.exp(-1j * turn)) / converter.source_amplitude
    ratio = np.log(found / gain[:, 0])
    expected = float(converter.deviation(gain[0])[0])
    assert np.std(ratio.real) == pytest.approx(expected, rel=0.1)
    assert np.std(ratio.imag) == pytest.approx(expected, rel=0.1)


def test_readings_have_the_noise_of_the_converter():
    readout = Readout(converter=Converter(**VOLTS))
    gain = np.full((4000, 1, 2), [0.9, 0.1j])
    measured = MeterSession(readout, 1, np.random.default_rng(1)).measure(
        gain, np.array([1e3, 2e3])
    )
    found = np.std(np.log(np.abs(measured)), axis=0)[0]
    np.testing.assert_allclose(found, readout.converter.deviation(gain[0, 0]), rtol=0.1)
    assert not readout.uniform and readout.noisy and not readout.exact
    assert readout.smallest_noise == pytest.approx(readout.converter.smallest_deviation)


def test_a_scene_keeps_its_converter():
    scene = STRIP.with_({**GAIN, "readout": {"converter": BITS}})
    assert parse_scene(scene_text(scene), "again") == scene
    assert "converter" not in scene_text(STRIP)
    assert "converter" not in STRIP.readout.model_dump_json()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"readout": {"converter": VOLTS}},
            '`readout.converter` is of interfaces with reader = "gain", got "impedance" of',
        ),
        (
            {**GAIN, "readout": {"converter": {"source_amplitude": 1.0}}},
            "`readout.converter` needs noise, in V rms, or bits with full_scale",
        ),
        (
            {**GAIN, "readout": {"converter": {"source_amplitude": 1.0, "bits": 8}}},
            "takes bits and full_scale together, got one of them",
        ),
        (
            {**GAIN, "readout": {"converter": {**BITS, "full_scale": 1.0}}},
            "`source_amplitude` must be <= 0.5 V, half of full_scale, got 1: the converter would",
        ),
    ],
)
def test_what_does_not_fit_is_refused(changes, message):
    assert message in refusal_of(STRIP.with_, changes)
