"""Limits without their pictures."""

import pytest


@pytest.fixture
def undrawn(monkeypatch):
    """Tables and summaries without their charts, which take half of the time."""
    for name in ("draw_maps", "draw_distances"):
        monkeypatch.setattr(f"rcskin.simulator.limits.figure.{name}", lambda *given: None)
