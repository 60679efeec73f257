"""The rivals of the benchmarks, which are scripts beside the packages and not installed."""

import importlib
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture(scope="session")
def rival():
    """A function from a name to the module of `benchmarks/rivals` of that name."""
    sys.path.insert(0, str(BENCHMARKS))
    yield lambda name: importlib.import_module(f"rivals.{name}")
    sys.path.remove(str(BENCHMARKS))
