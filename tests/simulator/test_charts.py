"""Charts are pictures or lines, by the ending of their file."""

import pytest
from rcskin.simulator.charts import ENDINGS, chart, checked_chart, checked_ending
from rcskin.simulator.sweeps import InputError

BEGINS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_chart_is_what_its_name_ends_in_and_the_same_bytes_again(tmp_path, ending):
    written = []
    for name in ("one", "other"):
        with chart(tmp_path / f"{name}{ending}", 2, 1) as figure:
            figure.subplots().plot([0, 1])
        written.append((tmp_path / f"{name}{ending}").read_bytes())
    assert written[0].startswith(BEGINS[ending])
    assert written[0] == written[1]


def test_other_endings_are_told_before_anything_is_drawn(tmp_path):
    assert checked_chart(tmp_path / "a.svg") == tmp_path / "a.svg"
    with pytest.raises(InputError, match="must end in .png or .svg or .pdf, got '.jpg'"):
        checked_chart(tmp_path / "a.jpg")


def test_charts_in_a_folder_have_the_ending_that_is_named():
    assert checked_ending("pdf") == ".pdf"
    with pytest.raises(InputError, match="--charts must be png or svg or pdf, got 'jpg'"):
        checked_ending("jpg")
