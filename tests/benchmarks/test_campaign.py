"""A scene of nearly each kind of the campaign: no error above its tolerance or estimate."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from rcskin.benchmarks.accuracy import campaign, campaign_routes

CHEAP = {
    "rectangles": 5,
    "discs": 3,
    "polygons": 3,
    "foils": 7,
    "films": 3,
    "one-sheet": 1,
    "lossy": 3,
    "behind-leads": 4,
    "of-varied-elements": 1,
    "anisotropic": 0,
    "anisotropic-touched-anyhow": 1,
    "gauges": 4,
    "gauges-touched-anyhow": 6,
    "gradients-and-random-fields": 7,
    "grids": 6,
    "maps-touched-anyhow": 8,
    "stretched": 3,
    "stretched-and-varied": 3,
    "draped": 0,
    "depths": 2,
    "forces": 6,
    "spread-depths": 6,
    "spread-forces": 6,
    "gauges-under-depths": 6,
    "overlapping-depths": 3,
    "spread-pairs": 1,
    "fed-all-around": 5,
    "holes": 7,
    "discs-cut-by-the-edge": 5,
    "outlines": 1,
    "rectangles-from-files": 3,
    "ls-from-files": 0,
    "annuli-from-files": 2,
    "bent-from-files": 3,
    "curved-from-files": 4,
}
"""The seed of each kind that takes least: a second, some of them four."""
QUICK = {
    "depths",
    "discs-cut-by-the-edge",
    "fed-all-around",
    "films",
    "forces",
    "gauges-under-depths",
    "grids",
    "lossy",
    "overlapping-depths",
    "rectangles-from-files",
    "spread-forces",
    "stretched-and-varied",
}
"""Kinds whose cheapest scene takes half a second: one of each way to press, to feed and to vary."""
DEAR = {"fed-along-arcs"}
"""Kinds that the campaign itself has: half a minute a scene."""


@pytest.mark.parametrize(
    "kind",
    [kind if kind in QUICK else pytest.param(kind, marks=pytest.mark.slow) for kind in CHEAP],
)
def test_the_tolerance_and_the_estimate_are_kept(kind):
    verdict = campaign.judged(kind, CHEAP[kind])
    assert verdict.outcome == "judged", verdict.line()
    assert not verdict.broken and not verdict.underestimated, verdict.line()


def test_no_kind_is_left_out():
    assert set(CHEAP) | DEAR == set(campaign.KINDS)


def test_the_same_seed_is_the_same_scene():
    drawn = campaign.drawn
    first, again, other = (drawn("rectangles", seed) for seed in (1, 1, 2))
    assert first.problem.tables == again.problem.tables
    assert (first.problem.press, first.rtol) == (again.problem.press, again.rtol)
    assert first.problem.tables != other.problem.tables


def test_what_is_off_is_found(monkeypatch):
    """An answer wrong by twice its tolerance, and one wrong by 1.5 times its estimate."""
    case = campaign.drawn("foils", 0)

    def off_by(error):
        class Wrong(campaign.Solver):
            def solve(self, press):
                answer = super().solve(press)
                return replace(answer, Z=(1 + error) * answer.Z)

        monkeypatch.setattr(campaign, "Solver", Wrong)
        return campaign.judged("foils", 0)

    kept, wrong = off_by(0.0), off_by(2 * case.rtol)
    assert (kept.outcome, kept.broken, kept.underestimated) == ("judged", False, False)
    assert (wrong.outcome, wrong.broken, wrong.underestimated) == ("judged", True, True)
    assert wrong.line().startswith(f"broken: foils seed 0 rtol {case.rtol:g}: ")
    estimated = max(np.max(kept.estimated), 1e-12)
    underestimated = off_by(1.5 * estimated)
    assert underestimated.underestimated


def test_an_exception_is_a_failure_and_reported(monkeypatch):
    class Broken(campaign.Solver):
        def solve(self, press):
            raise ZeroDivisionError("division by zero")

    monkeypatch.setattr(campaign, "Solver", Broken)
    verdict = campaign.judged("foils", 0)
    assert verdict.outcome == "failed"
    assert "ZeroDivisionError" in verdict.line()


def test_doubt_of_the_reference_is_set_aside():
    Verdict = campaign.Verdict
    errors = {"estimated": [[[1e-5]], [[1e-5]]], "frequency": (1.0,)}
    for true, doubt, broken in ((1.2e-4, 1e-5, True), (1.2e-4, 3e-5, False)):
        values = {"true": [[[true]], [[0.0]]], "uncertain": [[[doubt]], [[doubt]]]}
        verdict = Verdict("foils", 0, 1e-4, "judged", **errors, **values)
        assert verdict.broken is broken
        assert verdict.underestimated


def test_a_record_is_read_as_it_was_written(tmp_path):
    Verdict = campaign.Verdict
    errors = {name: [[[1e-5, 2e-6]]] * 2 for name in ("true", "estimated", "uncertain")}
    judged = Verdict("foils", 1, 1e-4, "judged", "", "elements", (1.0, 20.0), **errors)
    refused = Verdict("foils", 2, 1e-6, "refused", "too many triangles, too few")
    lines, table = tmp_path / "lines.jsonl", tmp_path / "table.csv"
    for verdict in (judged, refused):
        campaign.appended(lines, verdict, "abc")
    with lines.open("a") as unfinished:
        unfinished.write('{"kind": "foi')
    read = list(campaign.read(lines, "abc"))
    assert list(campaign.read(lines, "other code")) == []
    campaign.write_table(table, read)
    for found in (read, campaign.published(table)):
        assert [(each.line(), each.broken) for each in found] == [
            (each.line(), each.broken) for each in (judged, refused)
        ]
        np.testing.assert_array_equal(found[0].errors, judged.errors)


@pytest.mark.slow
def test_a_case_that_takes_too_long_is_given_up():
    cases = [("gauges", 0), ("foils", 0)]
    given_up, judged = campaign.verdicts(cases, workers=1, timeout=5.0)
    assert (given_up.outcome, judged.outcome) == ("not judged", "judged")


def test_laws_of_foam_are_those_of_the_simulator():
    """The campaign writes them once more, from what the pages say."""
    from rcskin.simulator.scene.foam_mechanics import Mechanics

    kinds = ("looyenga", "lichtenecker", "maxwell-garnett", "bruggeman", "constant")
    for law, strain in itertools.product(kinds, (0.1, 0.6)):
        tables = {"porosity": 0.7, "effective_medium": law, "modulus": 3e4}
        tables |= {"densification_strain": 0.65}
        if law != "constant":
            tables["solid_permittivity"] = 3.0
        mechanics = Mechanics.model_validate(tables)
        at = np.array(strain)
        assert campaign_routes.capacitance_factor(tables, strain) == pytest.approx(
            mechanics.factor(at)
        )
        assert campaign_routes.stress(tables, strain) == pytest.approx(mechanics.elastic.stress(at))
