"""All benchmarks by one command, and the tables that pages quote from them."""

import sys

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
    assert {benchmark.name for benchmark in every.IN_ORDER} == scripts


@pytest.fixture
def page(tmp_path, monkeypatch):
    (tmp_path / "told.md").write_text(
        "# Told\n\n| who | of what | how fast |\n| --- | --- | --- |\n| a | b | 2.5 |\n"
    )
    monkeypatch.setattr(quoted, "RESULTS", tmp_path)
    monkeypatch.setattr(quoted, "ROOT", tmp_path)
    monkeypatch.setattr(quoted, "pages", lambda: [tmp_path / "page.md"])
    return tmp_path / "page.md"


def test_a_quote_that_differs_is_told_and_written_anew(page, monkeypatch, capsys):
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
        name = "/".join(command[1].removesuffix(".py").split("/")[-2:])
        ran.append(name)
        return every.Times(1.0, 2.0, codes.get(name, 0))

    for name, value in {"timed": timed, "RESULTS": tmp_path, "NOTED": tmp_path / "all.csv"}.items():
        monkeypatch.setattr(every, name, value)
    monkeypatch.setattr(every, "commit", lambda: "abc")
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


def test_a_quick_pass_keeps_nothing_and_runs_each_script_as_often_as_it_differs(
    monkeypatch, tmp_path
):
    code, ran = run(monkeypatch, tmp_path, {}, "--quick")
    different = {(benchmark.name, benchmark.quick) for benchmark in every.IN_ORDER}
    assert code == 0 and sorted(ran) == sorted(name for name, _ in different)
    assert ran.count("localization/twin_design") == 4
    assert not [*tmp_path.iterdir()]
