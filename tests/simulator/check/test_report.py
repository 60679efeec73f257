"""Checking sweeps: noise told from themselves, laws judged by it, and what the report says."""

import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.check.report import checked_report, explanations, report_of, write_report
from rcskin.simulator.sweeps import InputError, read
from rcskin.simulator.sweeps.examination import KRAMERS_KRONIG, examine
from rcskin.simulator.sweeps.passivity import RESOLUTION

MEASURED = Path(__file__).parents[4] / "shared" / "data" / "blocking_line_eis.csv"
FREQUENCY = np.geomspace(1e3, 2e5, 20)
S = 2j * np.pi * FREQUENCY
NOISE = 1e-3


def line(RC=1e-5):
    q = np.sqrt(S * np.asarray(RC)[..., None])
    return 1e5 / (q * np.tanh(q))


def noisy(Z, seed, noise=NOISE):
    real, imaginary = np.random.default_rng(seed).standard_normal((2, *Z.shape))
    return Z * (1 + noise * (real + 1j * imaginary))


@pytest.fixture(scope="module")
def judge(make_sweeps):
    """A function that judges spectra, shape (sweep, frequency), of one interface."""

    def judge(Z, noise=None, tolerance=0.02, **labels):
        Z = np.atleast_2d(Z)
        sweeps = make_sweeps(len(Z), ["meter"], FREQUENCY, Z[:, None], **labels)
        return examine(sweeps, noise, tolerance)

    return judge


def laws(judgements):
    return [{each.law for each in judgement.broken} for judgement in judgements]


def test_each_interface_is_checked_at_its_own_frequencies(make_sweeps):
    Z = np.stack([noisy(line(np.full(4, 1e-5)), 1), noisy(line(np.full(4, 2e-5)), 2)], axis=1)
    taken = np.ones((2, FREQUENCY.size), dtype=bool)
    taken[1, ::3] = False
    Z[2, 1, 10] *= 1.2
    whole = make_sweeps(4, ["left", "bottom"], FREQUENCY, Z)
    thin = whole.where(np.broadcast_to(taken, Z.shape))
    judged = examine(
        thin.assign_coords(taken=(("interface", "frequency"), taken.astype(np.int8))), NOISE
    )
    assert [each.spectrum.frequency.size for each in judged] == 4 * [20] + 4 * [taken[1].sum()]
    assert [bool(each.broken) for each in judged] == 6 * [False] + [True, False]
    alone = examine(whole.isel(interface=[1], frequency=np.flatnonzero(taken[1])), NOISE)
    for one, other in zip(judged[4:], alone, strict=True):
        np.testing.assert_array_equal(one.spectrum.residual, other.spectrum.residual)


@given(seed=st.integers(0, 2**32 - 1), noise=st.sampled_from([0, 1e-6, 1e-3, 1e-2]))
def test_noise_alone_breaks_no_law(judge, seed, noise):
    spread = 10.0 ** np.random.default_rng(seed).uniform(-7, -4, 6)
    assert laws(judge(noisy(line(spread), seed, noise))) == [set()] * 6


def test_noise_is_estimated_from_the_residuals(judge):
    judged = judge(noisy(line(np.geomspace(1e-6, 1e-5, 10)), 1))
    assert judged[0].noise_from == "fit"
    assert np.median(judged[0].noise) == pytest.approx(NOISE, rel=0.2)


def test_noise_is_estimated_from_repeats_of_presses_of_unequal_strength(judge):
    Z = noisy(line(1e-5 * (1 + 0.02 * np.arange(10))), 1)
    judged = judge(Z, press=["1,1"] * 10)
    assert judged[0].noise_from == "repeats"
    assert np.median(judged[0].noise) == pytest.approx(NOISE, rel=0.2)


def test_sweeps_of_another_session_are_no_repeats(judge):
    judged = judge(noisy(line(np.full(2, 1e-5)), 1), press=["1,1"] * 2, session=[0, 1])
    assert judged[0].noise_from == "fit"


def test_noise_that_is_known_is_taken(judge):
    (judged,) = judge(line(), noise=0.01)
    assert judged.noise_from == "given"
    assert (judged.noise == 0.01).all()


def test_a_spectrum_without_noise_has_that_of_the_fit(judge):
    (judged,) = judge(line())
    assert (judged.noise == RESOLUTION).all()


@given(place=st.integers(0, 19), sweep=st.integers(0, 4), factor=st.sampled_from([0.97, 1 + 0.03j]))
def test_one_bad_reading_is_flagged_at_its_frequency(judge, place, sweep, factor):
    Z = noisy(line(np.geomspace(1e-6, 1e-5, 5)), 3, 2e-4)
    Z[sweep, place] *= factor
    judged = judge(Z)
    (found,) = [each for each in judged[sweep].broken if each.law == KRAMERS_KRONIG]
    assert FREQUENCY[place] in found.frequency
    assert [bool(each.broken) for each in judged] == [each == sweep for each in range(5)]


@pytest.mark.parametrize(
    ("law", "Z"),
    [
        ("Re Z >= 0", -5e4 + line()),
        ("Im Z <= 0", line().conj()),
        ("Rs not increasing", 1e3 * (1 + 0.05 * np.log(FREQUENCY)) + 1 / (S * 1e-7)),
        ("Cp not increasing", 1 / (1e-6 + S * 1e-9 * FREQUENCY**0.03)),
        ("Cs not increasing", 1e3 + 1 / (S * 1e-9 * FREQUENCY**0.03)),
        (KRAMERS_KRONIG, line() * np.exp(-1j * np.radians(10))),
    ],
)
def test_every_law_can_be_broken_beyond_the_noise(judge, law, Z):
    (found,) = laws(judge(noisy(Z, 1)))
    assert law in found


def test_a_misfit_beyond_the_tolerance_is_flagged_however_smooth(judge):
    Z = line() * np.exp(-1j * np.radians(1))
    (judged,) = judge(Z, tolerance=0.02)
    assert KRAMERS_KRONIG not in {each.law for each in judged.broken}
    (judged,) = judge(Z, tolerance=judged.spectrum.misfit / 2)
    assert KRAMERS_KRONIG in {each.law for each in judged.broken}


def test_inductive_readings_are_excluded_and_the_others_are_checked_behind_the_inductance(judge):
    Z = noisy(50 + 1 / (S * 1e-6) + S * 5e-6, 1)
    (judged,) = judge(Z)
    (found,) = judged.broken
    resonance = 1 / (2 * np.pi * np.sqrt(1e-6 * 5e-6))
    assert found.law == "Im Z <= 0"
    assert found.frequency == tuple(FREQUENCY[FREQUENCY > resonance])
    assert judged.spectrum.inductance == pytest.approx(5e-6, rel=0.1)
    assert "checked behind" in explanations([judged])[1]


def test_a_sign_that_noise_may_have_turned_is_no_inductance(judge):
    Z = np.full(FREQUENCY.shape, 1e3 + 0j) * (1 + 1e-3j * np.where(np.arange(20) > 17, 1, -1))
    (judged,) = judge(Z, noise=1e-3)
    assert judged.broken == ()
    assert not judged.spectrum.inductive.any()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"noise": 0.0}, "`noise` must be finite and > 0, got 0.0"),
        ({"tolerance": np.nan}, "`tolerance` must be finite and > 0, got nan"),
        ({}, "noise cannot be estimated from 3 frequencies: at least 6 are needed"),
    ],
)
def test_sweeps_that_cannot_be_checked_are_refused(make_sweeps, arguments, told):
    with pytest.raises(InputError, match=told):
        examine(make_sweeps(), **arguments)


def test_few_frequencies_are_checked_with_a_given_noise(make_sweeps):
    f = np.array([1e3, 2e3, 4e3])
    Z = np.broadcast_to(50 + 1 / (2j * np.pi * f * 1e-6), (2, 2, 3)).copy()
    Z[1, 1] = Z[1, 1].conj()
    judged = examine(make_sweeps(frequency=f, Z=Z), noise=1e-3)
    assert [bool(each.broken) for each in judged] == [False, False, False, True]
    assert (judged[3].sweep, judged[3].interface) == (1, "bottom")


def test_a_reading_of_zero_ohm_is_refused(judge):
    with pytest.raises(InputError, match="Z is 0 ohm at some frequency"):
        judge(np.zeros(20), noise=0.1, shown={"Cp": np.ones((1, 1, 20))})


@pytest.fixture(scope="module")
def measured():
    if not MEASURED.exists():
        pytest.skip(f"the measured sweep {MEASURED.name} is not beside the project")
    return read(MEASURED)


def test_of_the_measured_line_the_inductive_part_is_flagged_and_the_rest_passes(measured):
    (judged,) = examine(measured)
    (found,) = judged.broken
    assert found.law == "Im Z <= 0"
    assert min(found.frequency) == 744.372606
    assert len(found.frequency) == 12
    assert judged.spectrum.misfit == pytest.approx(0.011, abs=0.001)


def test_below_250_Hz_the_measured_line_keeps_every_law(measured):
    (judged,) = examine(measured.sel(frequency=slice(None, 250)))
    assert judged.broken == ()
    low, high = judged.phase
    assert -90 < low < -80
    assert -20 < high < 0


def test_cut_off_below_744_Hz_the_measured_line_still_shows_inductance_in_Cs(measured):
    (judged,) = examine(measured.sel(frequency=slice(None, 700)))
    assert {each.law for each in judged.broken} == {"Cs not increasing"}


def test_a_folder_holds_the_chart_every_verdict_and_every_residual(judge, tmp_path):
    judged = judge(np.array([line(), line().conj()]))
    write_report(report_of(judged), tmp_path / "report")
    names = {path.name for path in (tmp_path / "report").iterdir()}
    assert names == {"residuals.png", "residuals.csv", "verdicts.csv"}
    assert len((tmp_path / "report" / "residuals.csv").read_text().splitlines()) == 1 + 2 * 20
    verdicts = (tmp_path / "report" / "verdicts.csv").read_text().splitlines()
    assert verdicts[1].endswith(",")
    assert "Im Z <= 0" in verdicts[2]


def test_an_unwritable_report_is_refused_first(tmp_path):
    (tmp_path / "taken").write_text("")
    for name, told in [
        ("report.html", r"must end in \.png, \.svg, \.pdf or be a folder"),
        ("absent/chart.png", "the folder .* does not exist"),
        ("taken", "is a file, not a folder"),
    ]:
        with pytest.raises(InputError, match=told):
            checked_report(tmp_path / name)


@given(
    seed=st.integers(0, 2**32 - 1),
    turn=st.floats(-20, 20),
    noise=st.sampled_from([0, 1e-3, 1e-2]),
    jump=st.floats(0.5, 2),
)
def test_the_law_of_Kramers_and_Kronig_is_broken_where_residuals_are_beyond_what_is_allowed(
    judge, seed, turn, noise, jump
):
    Z = noisy(np.array([line(), line(3e-6)]), seed, noise)
    Z[1] *= np.exp(1j * np.radians(turn))
    Z[1, 7] *= jump
    for judged in judge(Z):
        residual, kept = judged.spectrum.residual, ~judged.spectrum.inductive
        further = (abs(residual.real) > judged.allowed) | (abs(residual.imag) > judged.allowed)
        told = [f for law in judged.broken if law.law == KRAMERS_KRONIG for f in law.frequency]
        assert told == FREQUENCY[further & kept].tolist()
        assert bool(told) or judged.spectrum.misfit <= 0.02


def test_tables_name_the_broken_laws_of_each_reading(judge, tmp_path):
    Z = line()
    Z[4] *= 1.5
    judged = judge(noisy(Z, 1))
    write_report(report_of(judged), tmp_path / "report")
    with (tmp_path / "report" / "residuals.csv").open() as file:
        rows = list(csv.DictReader(file))
    for law in judged[0].broken:
        told = [float(row["frequency_Hz"]) for row in rows if law.law in row["broken"]]
        assert told == list(law.frequency)
