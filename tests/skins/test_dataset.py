"""Data sets of skins that are not plain: what is pressed, where it lies, and how near it is."""

import numpy as np
import pytest
from rcskin.simulator.dataset.plan import Plan
from rcskin.simulator.dataset.presses import drawn_presses
from rcskin.simulator.dataset.run import generate
from rcskin.simulator.fem.estimate import relative_difference
from rcskin.simulator.mesh.held import held
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.skin import on_skin
from rcskin.simulator.sweeps import InputError, impedance, open_zarr

RTOL = 1e-3
SAME = {
    "dataset.session.sheet_resistance": 1.0,
    "dataset.session.sheet_mismatch": 1.0,
    "dataset.session.unevenness": 0.0,
    "dataset.session.capacitance": 1.0,
    "dataset.session.foam_spread": 0.0,
    "dataset.session.loss_tangent": 0.0,
    "dataset.session.contact_resistance": 1.0,
    "dataset.session.stray_capacitance": 0.0,
    "dataset.session.lead_resistance": 0.0,
    "readout.magnitude_noise": 0.0,
    "readout.phase_noise": 0.0,
    "readout.display_digits": 12,
}
ANYWHERE = {"dataset.press.place": "anywhere", "dataset.press.cells_per_pixel": 4}


def made(scene, path, sweeps=40):
    generate(Plan(scene, sweeps, 1, RTOL), path)
    return open_zarr(path).load()


HOLED = pytest.param("l with a hole", marks=pytest.mark.slow)


@pytest.mark.parametrize("name", [HOLED, "uneven", "piezoresistive", "mesh"])
def test_sweeps_are_those_of_the_full_model(kinds, tmp_path, name):
    scene = kinds[name].with_(SAME)
    data = made(scene, tmp_path / "out.zarr")
    there = [
        (k // scene.pixels.columns + 1, k % scene.pixels.columns + 1) for k in held(scene).numbers
    ]
    pressed = {*zip(data["row"].values.tolist(), data["column"].values.tolist(), strict=True)}
    assert pressed - {(0, 0), (-1, -1)} == set(there)
    solver, Z = Solver(scene, RTOL / 10), impedance(data)
    for k in (3, 17):
        truth = solver.solve(parse_press(str(data["press"].values[k]), np.nan)).Z
        off = relative_difference(Z[k], truth, 2 * np.pi * scene.frequencies).max()
        assert off <= data.attrs["audit_bound"] + RTOL / 10 <= 1.1 * RTOL


def test_a_rectangle_drawn_as_an_outline_gives_the_data_of_a_rectangle(kinds, make_scene, tmp_path):
    plain = make_scene(rows=2, columns=2, length=0.12, width=0.12)
    corners = [[0, 0], [0.12, 0], [0.12, 0.12], [0, 0.12]]
    drawn = plain.with_(
        {
            "skin.outline": {"points": corners},
            "contact.top-left.edge": "outline.4",
            "contact.bottom-left.edge": "outline.4",
        }
    )
    assert (plain.plain, drawn.plain) == (True, False)
    one, other = (made(each, tmp_path / f"{each.plain}.zarr") for each in (plain, drawn))
    assert one["press"].values.tolist() == other["press"].values.tolist()
    for name in ("Rs", "Cp"):
        np.testing.assert_allclose(one[name], other[name], rtol=2 * RTOL)
    np.testing.assert_allclose(one["touch_x"], other["touch_x"], atol=1e-7)


def test_pixels_are_told_by_the_middle_of_their_skin(kinds):
    scene = kinds["mesh"]
    presses = drawn_presses(scene, np.random.default_rng(1), 100, (1, 2))
    single = presses.touches == 1
    expected = np.where(presses.column[single] == 1, 0.02, 0.10)
    np.testing.assert_allclose(presses.x[single, 0], expected)
    np.testing.assert_allclose(presses.y[single, 0], 0.03)


def test_touches_anywhere_have_their_middles_on_the_skin(kinds):
    scene = kinds["l with a hole"].with_(ANYWHERE)
    presses = drawn_presses(scene, np.random.default_rng(1), 300, (8, 8))
    there = np.arange(2) < presses.touches[:, None]
    x = np.stack([presses.x[there], presses.y[there]])
    within = on_skin(scene.skin, x)
    assert 0.8 < within.mean()  # the others lie in cells that are partly skin
    assert held(scene.with_({"pixels.rows": 8, "pixels.columns": 8})).part.sum() < 0.75 * 64
    assert len({str(each) for each in presses.text}) > 250


@pytest.mark.slow
def test_touches_anywhere_are_as_near_as_their_cells_are_told_to_be(kinds, tmp_path):
    scene = kinds["draped"].with_({**SAME, **ANYWHERE})
    data = made(scene, tmp_path / "out.zarr", 8)
    solver, Z = Solver(scene, RTOL / 10), impedance(data)
    truth = solver.solve(parse_press(str(data["press"].values[5]), np.nan)).Z
    off = relative_difference(Z[5], truth, 2 * np.pi * scene.frequencies).max()
    assert RTOL < data.attrs["cells_error"] < 0.1
    assert off <= 2 * data.attrs["cells_error"] + RTOL


def test_a_hand_beside_pixels_that_are_groups_is_refused(kinds):
    scene = kinds["mesh"].with_({"dataset.press.offset": 0.1})
    told = "`dataset.press.offset` must be 0 where `pixels.groups` says what pixels are, got 0.1"
    with pytest.raises(InputError, match=told):
        Plan(scene, 10, 1, RTOL)
