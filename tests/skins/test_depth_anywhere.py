"""Touches anywhere pressed by depth: as near to the full model as a data set tells."""

from dataclasses import replace
from functools import cache

import meshio
import numpy as np
import pytest
from rcskin import __main__ as rcskin
from rcskin.simulator.dataset import cell_errors
from rcskin.simulator.dataset.cell_errors import lattice_error, rasterization_error
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.drawn_presses import drawn_presses
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.skin_model import REDUCED, Training
from rcskin.simulator.dataset.touch_places import (
    cell_presses,
    cell_presses_by_triangles,
    place_texts,
    written_strengths,
)
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.press.rasterized import TouchBatch
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.scene.skin_region import on_skin
from rcskin.simulator.sweeps import InputError
from typer.testing import CliRunner

RTOL, SEED = 1e-3, 1
COARSE = {"dataset.press.cells_per_pixel": 2, "dataset.session.sweeps_per_session": 10}
FOAM = {
    "skin.foam": {
        "thickness": 4e-3,
        "mechanics": {
            "porosity": 0.67,
            "solid_permittivity": 2.79,
            "modulus": 30e3,
            "tension": 20.0,
        },
    },
    "press": {"depth": 2e-3},
}
ANYWHERE = {
    "dataset.press.place": "anywhere",
    "dataset.press.cells_per_pixel": 4,
    "dataset.press.depth": {"distribution": "uniform", "low": 3e-4, "high": 2.2e-3},
    "dataset.session.unevenness": 0.0,
}


@pytest.fixture
def scenes(kinds, make_scene):
    flat = make_scene(rows=2, columns=2, length=0.12, width=0.12)
    return {
        name: each.with_({**FOAM, **ANYWHERE}) for name, each in {"flat": flat, **kinds}.items()
    }


def at_the_worst(scene):
    """Presses in a corner, along an edge, over a hole's rim, and two that overlap."""
    disc = np.array([[False, False], [True, False], [True, False], [False, True]])
    x = np.array([[0.006, 0.0], [0.05, 0.0], [0.044, 0.0], [0.03, 0.037]])
    y = np.array([[0.008, 0.0], [0.0065, 0.0], [0.03, 0.0], [0.055, 0.052]])
    width = np.array([[0.012, 0.0], [0.013, 0.0], [0.01, 0.0], [0.02, 0.012]])
    height = np.array([[0.016, 0.0], [0.013, 0.0], [0.01, 0.0], [0.012, 0.012]])
    factor = np.ones_like(x)
    depths = np.array([2.1e-3, 2e-3, 1e-3, 2.2e-3, 1.2e-3])
    factor[[0, 1, 2, 3, 3], [0, 0, 0, 0, 1]] = scene.parts.skin.pressed_factors(depths)
    counts = np.array([1, 1, 1, 2])
    return TouchBatch(counts, disc, x, y, width, height, factor, 0 * factor)


trained = cache(REDUCED.train)
"""Tests of the same scene share its model."""


@pytest.fixture
def compared(monkeypatch):
    """A function: errors are told of so many presses."""
    return lambda count: monkeypatch.setattr(cell_errors, "SAMPLE", count)


def test_estimated_errors_cover_those_of_some_others(scenes, compared):
    compared(2)
    covered(scenes["flat"].with_(COARSE), 1)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["flat", "l with a hole", "uneven"])
def test_estimated_errors_cover_those_of_other_presses_and_the_worst(scenes, name):
    covered(scenes[name], 10, at_the_worst(scenes[name]))


def covered(scene, count, *others):
    """Whether errors told hold for so many presses drawn, and for others."""
    family = trained(scene.parts, RTOL)
    of_cells = rasterization_error(scene.parts, family, SEED, RTOL)
    of_deflections = lattice_error(scene.parts, family, SEED)
    own = family.at(None)
    drawn = drawn_presses(scene.parts, np.random.default_rng(7), count, family.grid)
    solver = Solver(scene.parts, RTOL / 10)
    for placed in (drawn.placed, *others):
        Z = own.sweeps(cell_presses(scene.parts.skin, scene.parts.plan, placed, family.grid))
        by_triangles = own.sweeps(
            cell_presses_by_triangles(scene.parts.skin, scene.parts.plan, placed, family.grid)
        )
        told = place_texts(placed, *written_strengths(scene.parts.skin, scene.press, placed))
        exact = np.stack([solver.solve(parse_press(text, np.nan)).Z for text in told])
        moved = relative_difference(Z, by_triangles).max()
        assert 0 < moved <= of_deflections
        assert moved < relative_difference(Z, exact).max() <= of_cells
    assert of_deflections < of_cells < 1e-2


def drawn_on(scene, sweeps=60):
    return drawn_presses(scene.parts, np.random.default_rng(1), sweeps, (8, 8))


def test_presses_are_written_with_the_depth_that_was_solved(scenes):
    presses, scene = drawn_on(scenes["flat"]), scenes["flat"]
    for text, touches, factor in zip(presses.text, presses.touches, presses.factor, strict=True):
        press = parse_press(text, np.nan)
        assert str(press) == text or not press.touches
        found = sorted(
            scene.parts.skin.pressed_factors(np.array([t.by.value for t in press.indented]))
        )
        np.testing.assert_allclose(found, sorted(factor[:touches]), rtol=1e-6)


def test_applicators_meet_the_skin_that_they_are_drawn_on(scenes):
    scene = scenes["l with a hole"]
    presses = drawn_on(scene)
    there = np.arange(2) < presses.touches[:, None]
    assert on_skin(scene.skin, np.stack([presses.x[there], presses.y[there]])).all()


def test_a_press_beside_its_pixel_is_labelled_by_that_pixel(scenes):
    scene = scenes["flat"].with_({"dataset.press.place": "pixel", "dataset.press.offset": 0.2})
    presses = drawn_on(scene)
    single = np.flatnonzero(presses.touches == 1)[0]
    row, column = presses.row[single], presses.column[single]
    assert presses.text[single].startswith(f"{row},{column}:") and presses.text[single][-1] == "m"
    _, rises = presses.batch.one(single)
    most = presses.factor[single, 0] - 1
    assert rises.max() <= most * (1 + 1e-9)
    assert ((rises > 0.01 * most) & (rises < 0.9 * most)).any()  # beside the applicator


@pytest.mark.slow
def test_bytes_are_the_same_by_two_workers_and_when_resumed(scenes, compared, tmp_path):
    compared(1)
    scene = scenes["flat"].with_(COARSE)
    plan = DatasetPlan(scene.parts, 30, SEED, RTOL, block_values=10 * len(scene.frequencies))
    training = Training(trained, REDUCED.save, cache(REDUCED.load))
    generate(plan, tmp_path / "one.zarr", training=training)
    generate(
        plan, tmp_path / "two.zarr", processes=2, training=replace(training, load=REDUCED.load)
    )

    def stop(work, done, total):
        if done == 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        generate(plan, tmp_path / "three.zarr", training=training, progress=stop)
    generate(plan, tmp_path / "three.zarr", training=training)
    one, *others = (bytes_of(tmp_path / f"{name}.zarr") for name in ("one", "two", "three"))
    assert len(one) > 20
    assert all(other == one for other in others)


def bytes_of(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.mark.slow
def test_positions_are_learned_and_reported_at_the_command_line(scenes, tmp_path):
    noise = {"readout.magnitude_noise": 1e-4, "readout.phase_noise": 1e-4}
    alone = {"dataset.press.touches": [0.1, 0.9], "dataset.session.sweeps_per_session": 100}
    scene = scenes["flat"].with_({**noise, **alone})
    (tmp_path / "foam.toml").write_text(scene_text(scene), encoding="utf-8")
    data, model = tmp_path / "foam.zarr", tmp_path / "position.npz"
    made = run("dataset", tmp_path / "foam.toml", "--sweeps", 300, "--rtol", 1e-3, "-o", data)
    assert "on a lattice causes" in made.output and "touches on cells" in made.output
    run("train", data, "--target", "position", "-o", model)
    run("evaluate", model, data, "-o", tmp_path / "found")
    assert "x" in run("localize", model, data).output


def run(*arguments):
    done = CliRunner().invoke(rcskin.app, [str(each) for each in arguments])
    assert done.exit_code == 0, done.output
    return done


def test_a_mesh_in_space_is_refused(scenes, tmp_path):
    points = np.array([[0, 0, 0], [0.12, 0, 0], [0.12, 0.06, 0.01], [0, 0.06, 0.01]])
    blocks = [("triangle", np.array([[0, 1, 2], [0, 2, 3]])), ("line", np.array([[0, 3]]))]
    tags = [np.array([1, 1]), np.array([2])]
    mesh = meshio.Mesh(
        points,
        blocks,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"skin": np.array([1, 2]), "rim": np.array([2, 1])},
    )
    meshio.write(tmp_path / "slope.msh", mesh, file_format="gmsh22", binary=False)
    edges = {"contact.top-left.edge": "rim", "contact.bottom-left.edge": "rim"}
    scene = scenes["flat"].with_({"skin.mesh": str(tmp_path / "slope.msh"), **edges})
    with pytest.raises(InputError, match="must lie in a plane for depth"):
        DatasetPlan(scene.parts, 10, SEED, RTOL)
