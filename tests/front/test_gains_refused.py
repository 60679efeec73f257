"""Commands for impedances refuse a scene of gains in one line."""

import pytest


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (
            ("view", "knit-36", "-o", "out.vtu"),
            "knit-36: view shows the field of one source, and interface 'left' is `driven_with`",
        ),
        (
            ("page", "knit-36", "-o", "page.html"),
            "knit-36: a page shows impedances, and the readings of this scene are gains; use",
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
