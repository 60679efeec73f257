"""The skin at rest of a live session: told against it as recordings are."""

from types import SimpleNamespace

import numpy as np
import pytest
from rcskin.hardware.live.live_baseline import RENEWAL_COUNT, LiveBaseline
from rcskin.hardware.live.session_log import baseline_dataset, model_dataset, read_baselines
from rcskin.hardware.live.touch_answer import NOTHING_PRESSED, TouchAnswer
from rcskin.hardware.meter.meter_reading import MeterReading
from rcskin.hardware.record.measured_sweep import InterfaceTrace, MeasuredSweep
from rcskin.localization.inputs.baselines import OPENING, RECENT, log_baselines, mean_baselines
from rcskin.simulator.sweeps import build, write
from rcskin.simulator.sweeps.reading_quantities import IMPEDANCE, KINDS
from rcskin.tests.hardware.live.live_rig import Columns

MODEL = Columns().model
QUIET, TOUCHED = TouchAnswer(NOTHING_PRESSED, 0.99), TouchAnswer("column 2", 0.99)
AT_REST = np.array([1e4 - 1e5j, 1e4 - 3e4j, 1e4 - 1e4j])


def sweep(grown):
    Z = AT_REST * (1 + grown)
    readings = tuple(map(MeterReading, Z.tolist()))
    return MeasuredSweep((InterfaceTrace(MODEL.frequencies, readings, "left"),))


def test_live_and_evaluation_compare_a_sweep_with_the_same_baseline_of_a_skin_that_drifts():
    """A recording of what live took for rest, and the sweeps in between; asked at every sweep."""
    random, rest, taken, known = np.random.default_rng(0), LiveBaseline(RECENT), [], []
    sweeps = [sweep(1e-4 * k + 1e-3 * random.standard_normal()) for k in range(150)]
    told = [QUIET] * 150
    told[40:70] = [TOUCHED] * 30
    for k, (each, answer) in enumerate(zip(sweeps, told, strict=True)):
        if not rest.complete:
            rest.add(each)
            taken.append(k)
            continue
        known.append((k, *mean_baselines(baseline_dataset(rest, MODEL))))
        if rest.follow(each, answer):
            taken.append(next(j for j in range(k + 1) if sweeps[j] is rest.sweeps[-1]))
    row = np.isin(np.arange(150), taken).astype(int) ^ 1
    Z = np.array([[trace.Z for trace in each.traces] for each in sweeps])
    press = ["none" if k in taken else "1,1" for k in range(150)]
    recording = build(
        Z, MODEL.frequencies, interface=["left"], press=press, row=row, column=row
    ).dataset()
    judged = log_baselines(recording)
    place = {k: number for number, k in enumerate(judged.rows.tolist())}
    same = [(k, *means) for k, *means in known if k - 1 not in taken]
    assert len(taken) > OPENING + RECENT and len(same) > 100
    for k, recent, opening in same:
        np.testing.assert_allclose(recent, judged.recent[place[k]], rtol=1e-12)
        np.testing.assert_allclose(opening, judged.opening[place[k]], rtol=1e-12)
    drifted = abs(known[-1][1] - known[-1][2]).max()
    assert drifted > 5e-3, "the latest follow the drift, the opening does not"


def test_no_sweep_of_a_steady_touch_ever_becomes_rest_however_long_it_lasts():
    rest = LiveBaseline(3)
    for _ in range(3):
        rest.add(sweep(0.0))
    for answer in (TOUCHED, TouchAnswer("cannot tell"), TouchAnswer(NOTHING_PRESSED, 0.9)):
        for _ in range(50 * RENEWAL_COUNT):
            assert not rest.follow(sweep(0.02), answer)
    assert all(each.traces[0].Z == pytest.approx(AT_REST) for each in rest.sweeps)


def test_a_sweep_in_which_a_touch_begins_is_not_taken_though_it_looks_like_rest():
    """Nothing is pressed for long, and each touch begins in the fifth quiet sweep or later."""
    rest = LiveBaseline(3)
    for _ in range(3):
        rest.add(sweep(0.0))
    for _ in range(20):
        for _ in range(RENEWAL_COUNT - 1):
            rest.follow(sweep(0.0), QUIET)
        rest.follow(sweep(0.01), QUIET)
        rest.follow(sweep(0.02), TOUCHED)
    assert all(each.traces[0].Z == pytest.approx(AT_REST) for each in [*rest.sweeps, *rest.opening])
    assert len(rest.opening) == 8


def test_a_part_of_a_sweep_never_becomes_rest_and_a_whole_one_is_asked_for_in_time():
    rest, due = LiveBaseline(2), []
    rest.add(sweep(0.0))
    rest.add(sweep(0.0))
    for _ in range(4 * RENEWAL_COUNT):
        due.append(rest.renewal_due)
        rest.follow(sweep(0.001) if rest.renewal_due else None, QUIET)
    assert sum(due) == 4 and len(rest.opening) == 2 and len(rest._opening) == 6
    for _ in range(2 * RENEWAL_COUNT):
        assert not rest.follow(None, QUIET)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_baselines_of_a_file_are_what_the_file_holds(tmp_path, kind):
    """Of every kind, where interfaces have frequencies of their own and a meter shows a Cp."""
    names, taken = ("left", "bottom"), np.array([[True, False, True], [False, True, True]])
    frequencies = [tuple(np.array(MODEL.frequencies)[read].tolist()) for read in taken]
    own = dict(zip(names, frequencies, strict=True))
    model = SimpleNamespace(**{**vars(MODEL), "interfaces": names, "own_frequencies": own})
    Z = AT_REST * (1 if kind is IMPEDANCE else 1e-6) * np.array([1, 1.1]).reshape(2, 1, 1)
    Z = Z.repeat(2, axis=1)
    shown = {"Cp": np.full(Z.shape, 1.5e-9)} if kind is IMPEDANCE else {}
    labels = {"press": ["none"] * 2, "row": [0, 0], "column": [0, 0]}
    made = build(
        Z, MODEL.frequencies, interface=names, **labels, shown=shown, kind=kind, taken=taken
    ).dataset()
    write(made, tmp_path / "rest.nc")
    again = model_dataset(read_baselines([tmp_path / "rest.nc"], model, force=True), model)
    assert set(again.data_vars) == set(kind.names)
    for name in kind.names:
        np.testing.assert_allclose(again[name].values, made[name].values, rtol=1e-14)
