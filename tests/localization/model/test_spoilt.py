"""Models with a flipped bit, cut short, or with arrays that do not fit each other are refused."""

import io
import zipfile
from dataclasses import fields, replace

import numpy as np
import pytest
from rcskin.localization.learners import networks
from rcskin.localization.model.localizer_file import KIND, LAYOUT, load, save
from rcskin.localization.model.training import train
from rcskin.localization.parts.plain import Plain, UnsoundError
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError, concatenate
from rcskin.simulator.sweeps.array_files import write_arrays
from rcskin.tests.spoiling import share_refused

FLIPS, CUTS = 60, 10


@pytest.fixture(scope="module")
def model(sheet):
    return train(sheet, "pixel", "ksvm-components", quantities=("Rs", "Cp"))


def test_a_model_with_a_flipped_bit_or_cut_is_refused_or_the_same(model, sheet, tmp_path):
    path = tmp_path / "model.npz"
    save(path, model)
    expected = model.predictor.decisions(model.features(sheet))

    def same(again):
        return np.array_equal(again.predictor.decisions(again.features(sheet)), expected)

    assert share_refused(path, load, same, FLIPS, CUTS) > 0.8


def test_an_array_put_in_the_place_of_another_is_noticed_by_the_digest(model, tmp_path):
    save(tmp_path / "model.npz", model)
    with (
        zipfile.ZipFile(tmp_path / "model.npz") as old,
        zipfile.ZipFile(tmp_path / "other.npz", "w") as new,
    ):
        for name in old.namelist():
            content = old.read(name)
            if name.endswith(".npy"):
                array = np.load(io.BytesIO(content))
                changed = io.BytesIO()
                np.save(changed, array + 1 if array.dtype.kind == "f" else array)
                content = changed.getvalue()
            new.writestr(name, content)
    with pytest.raises(InputError, match=r"other\.npz: spoilt: its contents are not what"):
        load(tmp_path / "other.npz")


def fields_of(value, path=()):
    """Paths of all fields of plain data, and of items of tuples."""
    if isinstance(value, Plain):
        for each in fields(value):
            if not each.metadata.get("transient"):
                yield from fields_of(getattr(value, each.name), (*path, each.name))
    elif isinstance(value, tuple):
        for number, part in enumerate(value):
            yield from fields_of(part, (*path, number))
    else:
        yield path


def held_by(value, path):
    for part in path:
        value = value[part] if isinstance(part, int) else getattr(value, part)
    return value


def put(value, path, part):
    """A copy with another part at the path, made anew from there up."""
    if not path:
        return part
    first, *rest = path
    if isinstance(first, int):
        return (*value[:first], put(value[first], rest, part), *value[first + 1 :])
    return replace(value, **{first: put(getattr(value, first), rest, part)})


def spoilt(value):
    """The same field in ways that no training leaves it."""
    if isinstance(value, np.ndarray):
        flat = np.arange(value.size).reshape(value.shape) == value.size - 1
        yield from (value[..., None], np.full(value.shape, None), str(value))
        if value.dtype.kind == "f" and value.size:
            yield from (np.where(flat, x, value) for x in (np.nan, np.inf))
        elif value.dtype.kind == "i" and value.ndim == 1:
            yield from (value - 1000, value + 10**6)
    elif isinstance(value, float):
        yield from (np.nan, np.inf, str(value), None)
    elif value is not None:
        yield 1j


CASES = {
    "ksvm-ovo": "column",
    "ksvm-components": "touches",
    "gaussian": "pixel",
    "network": "column",
    "kernel-ridge": "position",
}


@pytest.fixture(scope="module", params=CASES)
def trained(request, make_sweeps):
    few = ("HIDDEN", (8,)), ("STAGES", ((1e-2, 20),))
    sweeps = concatenate([make_sweeps(1, 3, rests=3, session=k, seed=k) for k in range(3)])
    sweeps = sweeps.assign_attrs(scene=scene_text(load_scene("strip-1x3")))
    with pytest.MonkeyPatch.context() as patch:
        for each in few:
            patch.setattr(networks, *each)
        quantities = "dlnZ,dphase,lnZ0,phase0,lnZ,phase"
        return train(sweeps, CASES[request.param], request.param, quantities=quantities)


def test_no_field_of_a_model_may_be_spoilt(trained):
    for path in fields_of(trained):
        names = path[-1] == "classes"
        for changed in () if names else spoilt(held_by(trained, path)):
            if changed is None and path[-1] == "independent":  # of a training of one session
                continue
            with pytest.raises((UnsoundError, TypeError)):
                put(trained, path, changed)
                pytest.fail(f"{path}: {changed!r}")


def test_no_array_may_be_of_another_size(trained):
    for path in fields_of(trained.learned):
        array = held_by(trained.learned, path)
        if isinstance(array, np.ndarray) and array.size:
            for changed in (array[:-1], np.concatenate([array, array[:1]])):
                with pytest.raises(UnsoundError):
                    put(trained, ("learned", *path), changed)


def test_what_does_not_fit_is_reported_where_the_digest_is_right(model, tmp_path):
    description, arrays = model.described()
    path = tmp_path / "model.npz"
    arrays["learned.predictor.parts.2.counts"] = arrays["learned.predictor.parts.2.counts"] + 1
    write_arrays(path, KIND, LAYOUT, {"model": description}, arrays)
    message = r"model\.npz: damaged or forged: `learned\.predictor\.parts\.2\.counts` must count"
    with pytest.raises(InputError, match=message):
        load(path)
