"""Refusals in one line, as every function of the package gives them."""

import pytest
from rcskin.simulator.sweeps import InputError


def refusal_of(function, *given, **more):
    """The line in which a call refuses what it is given."""
    with pytest.raises(InputError) as refused:
        function(*given, **more)
    line = str(refused.value)
    assert "\n" not in line
    return line
