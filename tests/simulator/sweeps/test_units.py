"""Numbers with units are understood, where they are certain, as their users mean them."""

import pytest
from rcskin.simulator.sweeps.units import in_si


@pytest.mark.parametrize(
    ("written", "plain"),
    [
        ("2cm", "0.02"),
        ("90 mm", "0.09"),
        ("0,09", "0.09"),
        ("20k", "20000"),
        ("35 kohm/sq", "35000"),
        ("200 kHz", "200000"),
        ("12pF", "1.2e-11"),
        ("150%", "1.5"),
        ("3 m", "3"),
    ],
)
def test_what_a_number_is_without_its_unit(written, plain):
    assert in_si(written) == plain


@pytest.mark.parametrize("written", ["", "2", "1e3", "2 apples", "x2", "1,2,3", "1.2.3k", "cm"])
def test_no_guess_where_nothing_is_certain(written):
    assert in_si(written) is None
