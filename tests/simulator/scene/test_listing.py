"""The page of keys is what the models say."""

from pathlib import Path

import pytest
from rcskin.simulator.scene.keys import paths
from rcskin.simulator.scene.scene import Scene

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "reference" / "keys.md").read_text(encoding="utf-8")


def test_the_page_is_what_the_command_prints(run):
    code, out, err = run("keys")
    assert (code, err) == (0, "")
    assert out == PAGE, "python docs/generate.py"


def test_every_key_is_on_the_page():
    names = {str(place[-1]) for place in paths(Scene)}
    assert len(names) > 80
    absent = {name for name in names if f"`{name}`" not in PAGE and f"`{name} = " not in PAGE}
    assert not absent


@pytest.mark.parametrize(
    "row",
    [
        "| `length` | number | m | must be given | from 1e-5 to 1000 |",
        "| `sheet_resistance` | number | ohm/sq | must be given | from 1e-6 to 1e12 |",
        "| `angle` | number | rad | `0.0` | from -360 to 360 |",
        '| `electrode` | `"top"` or `"bottom"` |  | must be given |  |',
        "| `frequencies` | list of numbers or table | Hz | must be given | length >= 1, "
        "length <= 100000, from 1e-6 to 1e12 |",
        "| `phase_exponent` | number |  | `1.0` | > 0.5, <= 1 |",
        "| `lead_resistance` | number or distribution | ohm | "
        '`{distribution = "uniform", low = 0.0, high = 2.0}` | from 0 to 1e12 |',
    ],
)
def test_a_row_has_type_unit_default_and_range(row):
    assert any(line.startswith(row) for line in PAGE.splitlines())


def test_every_row_has_a_meaning():
    rows = [line for line in PAGE.splitlines() if line.startswith("| `")]
    assert len(rows) > 250
    assert not [row for row in rows if row.endswith("|  |")]
    heads = {line for line in PAGE.splitlines() if line.startswith("| key ")}
    assert all(head.endswith("| meaning |") for head in heads)


def test_a_row_has_the_meaning_that_the_docstring_gives():
    row = next(line for line in PAGE.splitlines() if line.startswith("| `loss_tangent` | number |"))
    assert row.endswith("| tan d in jwC (1 - j tan d). |")
