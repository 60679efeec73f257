"""Skins of every kind that is not plain, coarse in pixels and frequencies, to be cheap."""

import pytest

NOT_PLAIN = ("hexagon", "l with a hole", "uneven", "piezoresistive", "mesh", "draped")


@pytest.fixture(scope="session")
def kinds(library):
    """A scene of each kind by name."""
    return {name: library.scene(name) for name in NOT_PLAIN}
