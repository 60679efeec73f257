"""`rcskin export` as its user meets it."""

import re

import numpy as np
import pytest
from rcskin.localization.model.localizer_file import load, save
from rcskin.localization.model.training import train
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import concatenate, read, write

onnx = pytest.importorskip("onnx", reason="onnx is not installed: pip install '.[onnx]'")


def test_export_writes_the_format_of_its_ending(run, make_sweeps, tmp_path):
    write(make_sweeps(), tmp_path / "data.zarr")
    code, out, err = run("export", tmp_path / "data.zarr", "-o", tmp_path / "out.nc")
    written = f"24 sweeps x 20 frequencies -> {tmp_path / 'out.nc'}\n"
    assert (code, out, err) == (0, written, "")
    np.testing.assert_array_equal(read(tmp_path / "out.nc")["Cp"], make_sweeps()["Cp"])


@pytest.fixture(scope="module")
def model(make_sweeps, tmp_path_factory):
    scene = scene_text(load_scene("strip-1x3").with_({"skin.length": 0.03}))
    known = concatenate([make_sweeps(session=k, seed=k) for k in range(3)])
    path = tmp_path_factory.mktemp("model") / "columns.npz"
    save(path, train(known.assign_attrs(scene=scene), "column", "ksvm-ovo"))
    return path


def test_a_model_becomes_a_graph_that_was_compared(run, model, tmp_path):
    pytest.importorskip("onnxruntime", reason="onnxruntime is not installed")
    output = tmp_path / "columns.onnx"
    code, out, err = run("export", model, "-o", output)
    first, last = out.splitlines()
    assert (code, err) == (0, "")
    assert first.startswith(f"{output}: takes Rs, X, baseline_Rs, baseline_X; compared with the ")
    assert "on simulated sweeps: 0 of " in first and last.startswith("column by ksvm-ovo: ")
    words = "--single", "--unguarded", "--overwrite"
    code, out, err = run("export", model, "-o", output, *words)
    assert code == 0 and "no guard: sweeps unlike the training are answered too" in out
    made = onnx.load(output)
    assert {each.name for each in made.graph.output} == {"probabilities", "label"}
    assert "compared_with_model" in {each.key for each in made.metadata_props}


def test_a_graph_is_compared_on_sweeps_of_a_file(run, model, make_sweeps, tmp_path):
    pytest.importorskip("onnxruntime", reason="onnxruntime is not installed")
    scene = load(model).problem.scene
    write(make_sweeps(seed=9).assign_attrs(scene=scene), tmp_path / "a.nc")
    code, out, err = run("export", model, "-o", tmp_path / "a.onnx", "--compare", tmp_path / "a.nc")
    assert code == 0 and "on sweeps of files: 0 of 23 labels differ, probabilities by up" in out


def test_a_model_becomes_c_code(run, model, tmp_path):
    output = tmp_path / "columns.c"
    code, out, err = run("export", model, "-o", output)
    first, last = out.splitlines()
    assert (code, err) == (0, "")
    assert "probabilities within 0.002 of the model's; not compiled here: cc -std=c99 -c" in first
    assert re.fullmatch(
        r"column by ksvm-ovo: tables of \d+\.\d kB in flash, \d\.\d kB of stack, 0\.2 kB for each "
        rf"baseline -> {output}, {output.with_suffix('.h')}",
        last,
    )
    assert '#include "columns.h"' in output.read_text()
    output.unlink()
    assert run("export", model, "-o", output)[0] == 2  # the header is still there
    assert run("export", model, "-o", output, "--unguarded", "--overwrite")[0] == 0


@pytest.mark.parametrize(
    ("given", "options", "message"),
    [
        ("model", ("-o", "a.txt"), "a.txt: must end in .onnx or .c, got '.txt'"),
        ("sweeps", ("-o", "a.csv", "--single"), "--single applies to a model, MODEL.npz"),
        ("sweeps", ("-o", "a.onnx"), "must end in .nc or .csv or .parquet or"),
        ("model", ("-o", "a.onnx", "--format", "csv"), "--format applies to sweeps, and this is a"),
        (
            "model",
            ("-o", "a.c", "--single"),
            "--single applies to a graph, OUT.onnx, not to C code",
        ),
        ("absent", ("-o", "a.onnx"), "absent.npz"),
    ],
)
def test_what_export_refuses(refused, model, make_sweeps, tmp_path, given, options, message):
    write(make_sweeps(), tmp_path / "data.nc")
    sources = {
        "model": model,
        "sweeps": tmp_path / "data.nc",
        "absent": tmp_path / "absent.npz",
    }
    placed = [tmp_path / each if each.startswith("a.") else each for each in options]
    assert message in refused("export", sources[given], *placed)
