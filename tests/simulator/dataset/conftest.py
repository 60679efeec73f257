"""The toy family, importable here and in processes that tests start."""

import os
from pathlib import Path

import pytest

HERE = str(Path(__file__).parent)


@pytest.fixture(autouse=True)
def toy_importable(monkeypatch):
    monkeypatch.syspath_prepend(HERE)
    others = [path for path in os.environ.get("PYTHONPATH", "").split(os.pathsep) if path]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([HERE, *others]))


@pytest.fixture
def toy(toy_importable):
    """The module `toy_family`."""
    import toy_family

    return toy_family


@pytest.fixture
def make(toy, tmp_path):
    """A function that makes a data set of the toy family and gives its path."""

    def make(name="out", plan=None, processes=1, **family):
        from rcskin.simulator.dataset.generation import generate

        output = tmp_path / f"{name}.zarr"
        plan = plan or toy.small_plan()
        generate(
            plan,
            output,
            processes=processes,
            training=toy.training(**family),
        )
        return output

    return make
