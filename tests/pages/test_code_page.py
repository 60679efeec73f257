"""The page of the code: whoever reads it finds any law in two steps, the row and the file."""

import pytest
from rcskin.docs import the_code

LAWS = {
    "error of a reduced model": ("certificate", "residual"),
    "touch by depth or by force": ("Equilibrium", "force"),
    "retry": ("retries", "failed"),
    "spread of skins over sessions": ("sheet_resistance", "lognormal"),
    "sign of X": ("Z.imag", "X"),
    "loss tangent": ("loss_tangent", "phase_exponent"),
    "the cells that a touch covers": ("cells", "rise"),
    "estimate of the error of Rs and Cp": ("Rs", "Cp"),
    "the errors of a reading": ("noise", "session"),
    "what no localizer can exceed": ("accuracy", "draws"),
    "when no answer is given": ("novel", "CANNOT_TELL"),
    "settings: set, read back, restored": ("restore", "original"),
}
"""What is looked for, and words of the law that its files have to hold."""


@pytest.fixture(scope="module")
def rows():
    return {row: names for rows in the_code.SUBJECTS.values() for row, names in rows.items()}


@pytest.mark.parametrize("sought", LAWS)
def test_a_law_is_found_in_two_steps(rows, sought):
    (names,) = (names for row, names in rows.items() if sought in row)
    files = {the_code.ROOT / the_code.place_of(name) for name in names}
    text = "".join(file.read_text(encoding="utf-8") for file in files)
    for word in LAWS[sought]:
        assert word in text, f"{word} in {files}"


def test_a_name_that_is_gone_is_reported():
    with pytest.raises(KeyError, match="no class or function Nothing"):
        the_code.place_of("Nothing")
