"""Streams of sweeps for PyTorch: those of `rcskin dataset`, by seed, shared between workers."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
import rcskin
from rcskin.localization.inputs.samples import samples_of
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.memory_dataset import in_memory
from rcskin.simulator.sweeps import InputError

torch = pytest.importorskip("torch", reason="PyTorch is not installed: pip install '.[torch]'")

from rcskin.localization import sweep_stream  # noqa: E402  needs PyTorch
from rcskin.localization.sweep_stream import class_names  # noqa: E402

SESSION, RTOL = 12, 1e-2


@pytest.fixture(scope="module")
def scene():
    session = {"sweeps_per_session": SESSION, "rest_every": 5}
    return rcskin.load("strip-1x3").with_({"dataset.session": session})


@pytest.fixture(scope="module")
def streams(scene):
    """A function that makes streams of one family of skins."""
    first = rcskin.SweepStream(scene, "column", rtol=RTOL)
    return lambda target="column", quantities=None, **more: rcskin.SweepStream(
        scene, target, quantities, rtol=RTOL, family=first.family, **more
    )


def taken(stream, count):
    return list(itertools.islice(iter(stream), count))


def rows(X):
    """Rows in an order of their own."""
    return X[np.lexsort(X.T)]


def test_the_sweeps_are_those_of_a_data_set(scene, streams):
    stream = streams(seed=3)
    sweeps = in_memory(
        DatasetPlan(scene.parts, sweep_stream.MIXED * SESSION, 3, RTOL), stream.family
    )
    samples = samples_of(sweeps, "column")
    X, y = map(torch.stack, zip(*taken(stream, len(samples.X)), strict=True))
    assert X.dtype == torch.float32 and y.dtype == torch.int64
    np.testing.assert_array_equal(rows(X.numpy()), rows(samples.X.astype(np.float32)))
    columns = [stream.classes[k] for k in y]
    assert sorted(columns) == sorted(map(str, samples.y))
    assert stream.quantities == samples.problem.quantities
    np.testing.assert_allclose(stream.mean, X.mean(axis=0), atol=1e-5)
    assert columns != sorted(columns)


def test_batches_are_single_sweeps_side_by_side(streams):
    """Also across the end of the sessions that are mixed."""
    single = taken(streams(), 140)
    for k, (X, y) in enumerate(taken(streams(batch=7), 20)):
        own, targets = zip(*single[7 * k : 7 * k + 7], strict=True)
        assert torch.equal(X, torch.stack(own)) and y.tolist() == [int(each) for each in targets]


def test_positions_are_three_numbers(streams):
    (X, y), *_ = taken(streams("position", "dlnZ,dphase", batch=5), 1)
    assert y.shape == (5, 3) and y.dtype == torch.float32 and len(X) == 5


def test_workers_share_the_sessions_without_overlap(streams, monkeypatch):
    stream = streams()
    size = len(stream._samples(0, None).X)
    alone = taken(stream, 2 * size)
    assert len({tuple(X.tolist()) for X, _ in alone}) == 2 * size
    for worker in range(2):
        info = SimpleNamespace(id=worker, num_workers=2)
        monkeypatch.setattr(sweep_stream, "get_worker_info", lambda info=info: info)
        for (X, y), (own, target) in zip(
            taken(stream, size), alone[worker * size : (worker + 1) * size], strict=True
        ):
            assert torch.equal(X, own) and torch.equal(y, target)


def test_equal_seeds_give_equal_bits_and_others_do_not(streams):
    one, same, other = (taken(streams(seed=seed), 3) for seed in (5, 5, 6))
    for (X, _), (again, _), (else_, _) in zip(one, same, other, strict=True):
        assert torch.equal(X, again) and not torch.equal(X, else_)


@pytest.mark.slow
def test_spawned_workers_repeat_themselves(streams):
    def first():
        loader = torch.utils.data.DataLoader(
            streams(batch=8), batch_size=None, num_workers=2, multiprocessing_context="spawn"
        )
        return taken(loader, 6)

    for (X, y), (again, targets) in zip(first(), first(), strict=True):
        assert torch.equal(X, again) and torch.equal(y, targets)


def test_classes_by_target(scene):
    assert class_names(scene.parts.skin, "column") == ("0", "1", "2", "3")
    assert class_names(scene.parts.skin, "row") == ("0", "1")
    assert class_names(scene.parts.skin, "pixel") == ("0,0", "1,1", "1,2", "1,3")
    assert class_names(scene.parts.skin, "touches") == ("0", "1", "2")
    assert class_names(scene.parts.skin, "pair")[-3:] == ("1,1+1,2", "1,1+1,3", "1,2+1,3")
    assert class_names(scene.parts.skin, "position") == ()


REFUSED = {
    "batch": ({"batch": 0}, "`batch` must be a whole number >= 1, got 0"),
    "target": ({"target": "colum"}, "`target` must be one of column, row, "),
    "quantities": ({"quantities": "Rz"}, "`quantities` must be of "),
    "seed": ({"seed": -1}, "`seed` must be in "),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name, streams):
    given, message = REFUSED[name]
    with pytest.raises(InputError, match=message):
        streams(**given)
