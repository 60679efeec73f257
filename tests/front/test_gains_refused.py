"""Commands for impedances refuse a scene of gains in one line."""

import pytest


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (
            ("view", "knit-36", "-o", "out.vtu"),
            "knit-36: a view of the field cannot take `interface.driven_with`: it is that of one",
        ),
        (
            ("page", "knit-36", "-o", "page.html"),
            "knit-36: a page cannot take `interface.reader`: it shows impedances; use",
        ),
        (
            ("meter", "serve", "--scene", "knit-36", "--port", "0"),
            "knit-36: an LCR meter reads impedances, and the readings of this scene are gains;",
        ),
    ],
)
def test_gains_where_impedances_are_needed(refused, tmp_path, monkeypatch, command, message):
    monkeypatch.chdir(tmp_path)
    assert message in refused(*command)
