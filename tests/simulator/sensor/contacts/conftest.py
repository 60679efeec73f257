import pytest
from rcskin import load


@pytest.fixture(scope="session")
def sharp():
    """A skin whose foam each patch presses alone."""
    return load("foam").with_({"skin.foam.mechanics.tension": 0.0})


@pytest.fixture(scope="session")
def linear(sharp):
    """The skin by Hooke's law, for closed forms."""
    return sharp.with_({"skin.foam.mechanics.stress_strain": "linear"})
