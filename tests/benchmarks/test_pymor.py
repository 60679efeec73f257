"""pyMOR's reduced basis is given the same equations, and keeps what it is asked."""

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.reduced.cases import pixel_touches
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

pytest.importorskip("pymor")


@pytest.fixture(scope="module")
def sheet():
    """A small reduced sheet of 2 x 2 pixels, by which the full matrices are found."""
    tables = load_scene("sheet-3x3").model_dump(by_alias=True, exclude_none=True)
    tables["pixels"] = {"rows": 2, "columns": 2}
    tables["sweep"] = {"frequencies": [40.0, 3e3, 200e3]}
    scene = Scene.model_validate(tables)
    return reduce(scene.parts, 1e-5)


def pressed(sheet, count, seed):
    random, draw = (
        np.random.default_rng(seed),
        pixel_touches(sheet.scene.parts.skin, sheet.scene.parts.plan),
    )
    return [draw(random) for _ in range(count)]


@pytest.mark.parametrize("turn", [2 * np.pi, 2j * np.pi])
def test_basis_of_pymor(sheet, turn):
    """Its error on unseen presses falls with what the field is asked, for real s and imaginary."""
    from rcskin.benchmarks.rivals import pymor_basis

    skin, frequencies = sheet.at(None), sheet.scene.frequencies
    matrices = pymor_basis.Matrices.of_family(sheet.family)
    seen = [skin.map_of(case.cells, case.rises).ravel() for case in pressed(sheet, 12, seed=1)]
    training = [(turn * f, c) for c in seen for f in frequencies]
    unseen = pressed(sheet, 4, seed=2)

    def error(rtol):
        basis = pymor_basis.Basis(matrices, training, rtol)
        found, truth = [], []
        for case in unseen:
            c = skin.map_of(case.cells, case.rises).ravel()
            found.append(basis.impedance(c, frequencies))
            truth.append(skin.exact(case.cells, case.rises)[0])
        return relative_difference(np.array(found), np.array(truth)).max()

    fine = error(1e-4)
    assert fine < 1e-4
    assert error(1e-2) > 10 * fine
