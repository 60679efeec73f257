"""The report: every chart, every documented number, one noun; both files or neither."""

import json
import math
import re
from dataclasses import replace

import pytest
from rcskin.localization.gap import gap_report
from rcskin.localization.gap.gap_report import accuracy_table, cause_sentence, charts_of
from rcskin.localization.gap.json_data import KEYS, numbers
from rcskin.simulator.calibration.misfit import JointEffect, MisfitCauses, ParameterEffect
from rcskin.simulator.chart_style import STYLE

CHARTS = {
    "distance-pressed",
    "distance-rest",
    "accuracy",
    "confusion-absolute",
    "confusion-relative",
    "distribution",
    "causes",
}


@pytest.fixture(scope="module", autouse=True)
def coarse():
    """Charts of few pixels, which take most of the time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(STYLE, "savefig.dpi", 40)
        yield


@pytest.fixture(scope="module")
def written(findings, tmp_path_factory):
    folder = tmp_path_factory.mktemp("gap")
    findings.write(folder)
    return folder


def leaves(node):
    if isinstance(node, dict | list):
        for each in node.values() if isinstance(node, dict) else node:
            yield from leaves(each)
    else:
        yield node


def keys(node):
    if isinstance(node, dict):
        for name, each in node.items():
            yield name
            yield from keys(each)
    elif isinstance(node, list):
        for each in node:
            yield from keys(each)


def test_the_page_holds_every_chart_and_nothing_from_elsewhere(written):
    page = (written / "gap.html").read_text()
    assert set(re.findall(r'<figure id="([^"]+)"', page)) == CHARTS
    assert page.count("data:image/png;base64,iVBOR") == len(CHARTS)
    assert not re.search(r'(src|href)="(?!data:)', page)
    assert {path.name for path in written.iterdir()} == {"gap.html", "gap.json"}


def test_a_twin_is_never_called_anything_else(written):
    for name in ("gap.html", "gap.json"):
        text = re.sub(r"base64,[^\"]+", "", (written / name).read_text())
        assert "twin" in text
        assert "measure" not in text.lower()


def test_a_measurement_is_called_one(pair_of_sweeps, make_findings):
    simulated, other = pair_of_sweeps
    measured = other.drop_attrs().assign_attrs(model="measured", scene=other.attrs["scene"])
    found = make_findings(simulated, measured)
    assert numbers(found)["compared"]["other"]["label"] == "measurement"
    assert accuracy_table(found).rows[-1][0] == "measured, cross-validated by sweep"


def test_every_number_is_finite_and_every_table_complete(written, findings):
    found = json.loads((written / "gap.json").read_text())
    assert all(math.isfinite(each) for each in leaves(found) if isinstance(each, float))
    assert set(found["distance"]) == set(found["discrepancy"]) == {"before", "after"}
    shape = len(found["interfaces"]), len(found["frequency_Hz"])
    for stage in found["distance"].values():
        for quantity, unit in (("Rs", "ohm"), ("Cp", "F")):
            for press in ("pressed", "rest"):
                tables = dict(stage[press][quantity])
                assert tables.pop("unit") == unit
                assert set(tables) == {
                    "simulated", "mean", "rms", "separation", "percent", "meter_error",
                    "in_meter_errors", "in_separations",
                }  # fmt: skip
                assert all((len(t), len(t[0])) == shape for t in tables.values())
    for stage in found["accuracy"]["transfer"].values():
        assert {name: set(each) for name, each in stage.items()} == {
            "absolute": {"0", "1", "2", "5"},
            "relative": {"0", "1", "2", "5"},
        }
    assert set(found["discrepancy"]["after"]["relative"]) == {"all", "0", "1", "2", "3"}


def test_every_key_is_documented(findings):
    found = dict(numbers(findings))
    documented = {name for told in KEYS for name in re.split(r", |\.", told)}
    assert set(found) - {"about", "software"} <= documented
    words = set(re.findall(r"\w+", " ".join([*KEYS, *KEYS.values()])))
    data = {"absolute", "relative", "before", "after", "0", "1", "2", "3", "5", "software"}
    del found["about"]
    assert set(keys(found)) <= words | data


def test_counts_add_up_to_what_was_tested(findings):
    found = numbers(findings)["accuracy"]["transfer"]["before"]["absolute"]
    for k, each in found.items():
        assert sum(map(sum, each["confusion"]["counts"])) == each["tested"]
        assert each["draws"] == (1 if k == "0" else 2)


def test_the_cause_is_reported_in_one_sentence(findings):
    assert re.fullmatch(
        r"Sheet resistance explains most of the gap: fitted alone, it removes \d+ % of the "
        r"misfit; next is [a-z ]+ with \d+ %\.",
        cause_sentence(findings),
    )


@pytest.mark.usefixtures("uncalibrated")
def test_classes_without_neighbours_are_no_unit(make_skin_sweeps, make_findings, tmp_path):
    strips = [make_skin_sweeps(4, seed=seed) for seed in (0, 1)]
    found = make_findings(*strips, target="row")
    tables = numbers(found)["distance"]["before"]["pressed"]["Rs"]
    assert tables["in_separations"] == [[None] * 8]
    charts_of(found)[0].draw(tmp_path / "distance.png")
    assert (tmp_path / "distance.png").stat().st_size


@pytest.mark.usefixtures("unpainted")
def test_charts_stand_beside_the_page_where_that_is_asked_for(findings, tmp_path, monkeypatch):
    first = charts_of(findings)[:1]
    monkeypatch.setattr(gap_report, "charts_of", lambda findings: first)
    findings.report.write(tmp_path, page="gap.html", charts=[".svg"])
    assert [path.stem for path in tmp_path.glob("*.svg")] == [first[0].name]


@pytest.mark.usefixtures("unpainted")
def test_a_chart_that_fails_leaves_nothing_behind(findings, tmp_path, monkeypatch):
    def fails(*arguments):
        raise RuntimeError

    monkeypatch.setattr("rcskin.localization.gap.gap_report.draw_accuracies", fails)
    with pytest.raises(RuntimeError):
        findings.write(tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("shares", "told"),
    [
        ((0.8, 0.3), "Foam explains most of the gap: fitted alone, it removes 80 % of the misfit; "
         "next is sheet with 30 %."),
        ((0.3, 0.001), "Foam explains a part of the gap: fitted alone, it removes 30 % of the "
         "misfit."),
        ((0.01, 0.0), "No parameter alone explains the gap: foam, the best one, removes 1 % "
         "of the misfit."),
    ],
)  # fmt: skip
def test_words_and_share_of_a_cause_agree(findings, shares, told):
    named = zip(("foam", "sheet"), shares, strict=True)
    causes = [ParameterEffect(name, 0.0, 1.0, 1 - share, name) for name, share in named]
    assert cause_sentence(replace(findings, causes=causes)) == told


def test_what_surrounds_a_skin_is_named_by_what_it_is(findings):
    body = ParameterEffect("body", 0.29, 1.0, 0.29, "a body at about 6 mm")
    found = replace(
        findings, causes=[body, ParameterEffect("finger", 1e-12, 1.0, 0.8, "a finger of 1 pF")]
    )
    assert cause_sentence(found) == (
        "A body at about 6 mm explains most of the gap: fitted alone, it removes 71 % of the "
        "misfit; next is a finger of 1 pF with 20 %."
    )
    assert numbers(found)["causes"][0] == {
        "parameter": "body",
        "share": pytest.approx(0.71),
        "change": "a body at about 6 mm",
    }


def test_a_pair_is_reported_with_what_was_tried_beside_it(findings):
    pairs = [
        JointEffect(("body", "rim"), 1.0, 0.01, ("a body at about 6 mm", "a rim of about 5 pF/m")),
        JointEffect(("lead_resistance", "rim"), 1.0, 0.2, ("lead_resistance +5 ohm", "a rim")),
    ]
    told = cause_sentence(replace(findings, together=pairs))
    assert told.endswith(
        " %. Fitted together, a body at about 6 mm and a rim of about 5 pF/m remove 99.0 % of the "
        "misfit; lead resistance and rim 80.0 %."
    )
    assert numbers(replace(findings, together=pairs))["causes_together"][1] == {
        "parameters": ["lead_resistance", "rim"],
        "share": pytest.approx(0.8),
        "changes": ["lead_resistance +5 ohm", "a rim"],
    }


@pytest.mark.usefixtures("unpainted")
def test_what_could_not_be_tried_is_a_remark(pair_of_sweeps, make_findings, tmp_path, monkeypatch):
    remark = "what surrounds the skin was not tried: no thickness"
    monkeypatch.setattr(
        "rcskin.simulator.calibration.misfit.gap_by_parameter",
        lambda *given, **more: MisfitCauses(remarks=(remark,)),
    )
    found = make_findings(*pair_of_sweeps)
    assert "What surrounds the skin was not tried: no thickness." in found.notes
    found.write(tmp_path)
    for name in ("gap.html", "gap.json"):
        assert (
            "What surrounds the skin was not tried: no thickness." in (tmp_path / name).read_text()
        )
