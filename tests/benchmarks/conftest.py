"""The rivals of the benchmarks, which are scripts beside the packages and not installed."""

import importlib

import pytest


@pytest.fixture(scope="session")
def rival():
    """A function from a name to the module of `benchmarks/rivals` of that name."""
    return lambda name: importlib.import_module(f"rcskin.benchmarks.rivals.{name}")
