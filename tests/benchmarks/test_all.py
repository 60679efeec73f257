"""All benchmarks by one command, and the tables that pages quote from them."""

import subprocess
import sys
from pathlib import Path
from threading import Barrier

import pytest
from rcskin.benchmarks import all as every
from rcskin.benchmarks import quoted
from rcskin.benchmarks.bench import HERE

PAGE = """# Page

<!-- quoted: told.md; who; how fast -->
| who | how fast |
| --- | --- |
| a | {} |

The end.
"""


def test_pages_quote_the_tables_that_were_written_last():
    assert [quote.told() for quote in quoted.differing()] == []
    assert sum(1 for page in quoted.pages() for _ in quoted.quotes(page)) >= 2


def test_no_benchmark_is_left_out():
    scripts = {
        path.relative_to(HERE).with_suffix("").as_posix()
        for path in HERE.glob("*/*.py")
        if 'if __name__ == "__main__"' in path.read_text(encoding="utf-8")
    }
    assert {benchmark.name for benchmark in every.IN_ORDER} == scripts | {"commands"}


@pytest.fixture
def page(tmp_path, monkeypatch):
    (tmp_path / "told.md").write_text(
        "# Told\n\n| who | of what | how fast |\n| --- | --- | --- |\n| a | b | 2.5 |\n"
    )
    monkeypatch.setattr(quoted, "RESULTS", tmp_path)
    monkeypatch.setattr(quoted, "ROOT", tmp_path)
    monkeypatch.setattr(quoted, "pages", lambda: [tmp_path / "page.md"])
    return tmp_path / "page.md"


def test_a_quote_that_differs_is_reported_and_written_anew(page, monkeypatch, capsys):
    page.write_text(PAGE.format("2.6"))
    monkeypatch.setattr(sys, "argv", ["quoted.py"])
    assert quoted.main() == 1
    assert capsys.readouterr().out == "page.md: line 4: told.md\n"
    monkeypatch.setattr(sys, "argv", ["quoted.py", "--write"])
    assert quoted.main() == 0
    assert page.read_text() == PAGE.format("2.5")


def run(monkeypatch, tmp_path, codes, *options):
    """Exit code, and the benchmarks that were run; codes: theirs, where not 0."""
    ran = []

    def timed(command):
        name = Path(command[1]).relative_to(HERE).with_suffix("").as_posix()
        ran.append(name)
        return every.Times(1.0, 2.0, codes.get(name, 0))

    noted = {"NOTED": tmp_path / "all.csv", "NOTED_QUICKLY": tmp_path / "quick" / "quick.csv"}
    for name, value in {"timed": timed, "UNPUBLISHED": tmp_path / "kept", **noted}.items():
        monkeypatch.setattr(every, name, value)
    monkeypatch.setattr(every, "code", lambda: "abc")
    monkeypatch.setattr(sys, "argv", ["all.py", *options])
    return every.main(), ran


def test_what_ended_well_is_not_run_again(monkeypatch, tmp_path, capsys):
    code, ran = run(monkeypatch, tmp_path, {"speed/skins": 1})
    assert code == 1 and len(ran) == len(every.IN_ORDER)
    assert "failed: speed/skins" in capsys.readouterr().out
    assert run(monkeypatch, tmp_path, {}) == (0, ["speed/skins"])
    assert run(monkeypatch, tmp_path, {}) == (0, [])
    assert run(monkeypatch, tmp_path, {}, "--only", "speed/skins", "--again") == (
        0,
        ["speed/skins"],
    )
    assert len((tmp_path / "all.csv").read_text().splitlines()) == 1 + len(every.IN_ORDER)


def test_a_quick_pass_goes_on_and_keeps_nothing_among_the_results(monkeypatch, tmp_path):
    """Each script is run as often as its quick passes differ."""
    different = dict.fromkeys((each.name, each.quick) for each in every.IN_ORDER)
    scripts = sorted(name for name, _ in different)
    assert scripts.count("localization/twin_design") == 5
    code, ran = run(monkeypatch, tmp_path, {"speed/skins": 1}, "--quick")
    assert (code, sorted(ran)) == (1, scripts)
    assert run(monkeypatch, tmp_path, {}, "--quick") == (0, ["speed/skins"])
    assert [path.name for path in tmp_path.iterdir()] == ["quick"]


def test_what_measures_times_runs_alone_and_before_the_rest(monkeypatch):
    """Begins and ends of four scripts, as they come."""
    told, together = [], Barrier(2)

    def timed(command):
        name = Path(command[1]).stem
        told.append(name)
        if name != "alone":
            together.wait(timeout=30)
        told.append(f"{name} ended")
        return every.Times(1.0, 2.0, 0)

    monkeypatch.setattr(every, "timed", timed)
    asked = [every.Benchmark(name, alone=name == "alone") for name in ("a", "b", "alone")]
    ended = [benchmark.name for benchmark, _ in every.run([*asked, asked[-1]], False)]
    assert told[:4] == ["alone", "alone ended"] * 2
    assert set(told[4:6]) == {"a", "b"} and ended[:2] == ["alone"] * 2


def test_two_that_keep_in_one_folder_do_not_run_at_once():
    pixel, others, free = (
        every.Benchmark(name, kept=kept)
        for name, kept in (("a", ("--found", "x")), ("b", ("--found", "x")), ("c", None))
    )
    assert every.next_of([others, free], [pixel]) == free
    assert every.next_of([others], [pixel]) is None
    assert every.next_of([others, free], []) == others
    assert every.next_of([free], [free]) == free


def test_what_reports_results_of_others_waits_for_all_of_them():
    one, other = (every.Benchmark("campaign", options=(option,)) for option in ("a", "b"))
    teller = every.Benchmark("teller", needs="campaign")
    assert every.next_of([teller, other], [one]) == other
    assert every.next_of([teller], [other]) is None
    assert every.next_of([teller], []) == teller


def test_others_of_a_design_go_on_from_what_its_twins_were_asked_with():
    kept = {(each.name, *each.options): (each.kept, each.shared) for each in every.IN_ORDER}
    asked = ("localization/twin_design", "--target", "pixel")
    assert kept[(*asked, "--others")] == kept[asked]
    assert None not in kept[asked]


def test_designs_of_twins_are_searched_once():
    """All goals of `twin_design` but the first ask `rcskin design` for what `design_goals` does."""
    from rcskin.benchmarks.localization import design_goals
    from rcskin.benchmarks.localization.designs import GOALS

    shown = {(goal.scene, goal.options + design_goals.USUAL) for goal in design_goals.GOALS}
    apart = [name for name, goal in GOALS.items() if (goal.trial.believed, goal.asked) not in shown]
    assert apart == ["pixel"]


def test_what_a_long_one_keeps_is_of_one_code(monkeypatch, tmp_path):
    monkeypatch.setattr(every, "UNPUBLISHED", tmp_path)
    kept, shared = ("--found", "own"), ("--searches", "searches")
    benchmark = every.Benchmark("a/b", ("--all",), kept=kept, shared=shared)
    for code, folder in ("abc", "abc"), ("abc and changes", "abc-and-changes"):
        monkeypatch.setattr(every, "code", lambda told=code: told)
        options = every.command_of(benchmark, quick=False)[2:]
        own, searches = (str(tmp_path / folder / name) for name in ("own", "searches"))
        assert options == ["--all", "--found", own, "--searches", searches]
        assert (tmp_path / folder).is_dir()
    assert every.command_of(benchmark, quick=True)[2:] == ["--quick"]


def test_times_of_quick_passes_are_no_part_of_the_repository():
    ignored = ["git", "-C", str(HERE.parent), "check-ignore", "-q", str(every.NOTED_QUICKLY)]
    assert subprocess.run(ignored).returncode == 0


def test_after_ctrl_c_no_other_begins(monkeypatch):
    begun = []

    def timed(command):
        begun.append(Path(command[1]).stem)
        raise KeyboardInterrupt

    monkeypatch.setattr(every, "timed", timed)
    asked = [every.Benchmark(name, alone=True) for name in ("first", "second")]
    with pytest.raises(KeyboardInterrupt):
        list(every.run(asked, quick=False))
    assert begun == ["first"]
