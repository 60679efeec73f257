"""What is true of every kind of skin in every model; `library/scenes` lists the kinds.

- A reduced model agrees with the full solver within its certificate, and within its tolerance.
- Its certificate bounds what the reduction leaves out, also on skins that it was not trained on.
- Its basis is orthonormal, its poles are negative, and its impedance is passive.
- It comes back from its file whole.
- Presses together have the results of presses one by one.
- A network of all terminals has the readings of a model of these readings.
- Slopes by parameters and by touches are differences.
- A data set has the sweeps of the full solver, and presses every pixel.
"""

import numpy as np
import pytest
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.network_skin import Network
from rcskin.simulator.models.parameters import Variation, own_values
from rcskin.simulator.models.reduced.cases import Case, pixel_touches
from rcskin.simulator.models.reduced.certificate import largest_bounds
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.terminals import chain, read
from rcskin.simulator.press.batch import PressBatch, TouchedCells
from rcskin.simulator.press.parts import foam_parts
from rcskin.simulator.press.pixels import pixels_with_skin
from rcskin.simulator.press.press import press_on
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.scene.frequency import Loss
from rcskin.simulator.sweeps import impedance, open_zarr, parallel_capacitance
from rcskin.tests.library.scenes import ALIKE, KINDS

KRYLOV = 0.03
"""Share of a model's tolerance that solves in its basis leave out."""
ROUGH = 0.1
"""Tolerance of models whose own answers are compared with each other alone."""
DEAR = ("hexagon near earth", "walls of a hexagon")
"""Kinds whose training takes long; laws that train a model of their own hold for quicker ones."""
TWO_TERMINALS = [name for name, kind in KINDS.items() if kind.rtol <= 1e-5]
"""Kinds from whose meter no current goes to earth, in models of close tolerance."""
BY_DEPTH = [name for name in KINDS if name.startswith("by depth")]


def kinds(*names, left_out=(), slow=()):
    """Parametrizes a law by some kinds, or by all but those left out."""
    return pytest.mark.parametrize(
        "name",
        [
            pytest.param(name, marks=pytest.mark.slow if KINDS[name].slow or name in slow else ())
            for name in names or KINDS
            if name not in left_out
        ],
    )


@pytest.fixture
def model(library, name):
    """The reduced model of a kind."""
    return library.model(name)


@pytest.fixture
def touches(library, name):
    """Cells and rises of each press of a kind."""
    scene = library.scene(name)
    return [
        touched_cells(scene.parts.skin, press_on(scene.parts.skin, scene.press, text))
        for text in KINDS[name].presses
    ]


def drawn(model, count):
    """Further touches of pixels that have skin."""
    random, draw = (
        np.random.default_rng(7),
        pixel_touches(model.parts.skin, model.parts.plan),
    )
    there = np.flatnonzero(np.abs(model.factors).sum(axis=(1, 2)))
    cases = [draw(random) for _ in range(5 * count)]
    return [(each.cells, each.rises) for each in cases if np.isin(each.cells, there).all()][:count]


@kinds()
def test_the_full_solver_agrees_within_the_certificate(library, model, touches, name):
    kind, scene, own = KINDS[name], library.scene(name), model.at(None)
    closely = 0.1 * kind.rtol
    solver = Solver(scene.parts, closely)
    for text, touched in zip(kind.presses, touches, strict=True):
        off = relative_difference(
            own.sweep(*touched), solver.solve(press_on(scene.parts.skin, scene.press, text)).Z
        )
        estimated = own.certificate(*touched) + model.mesh_error + KRYLOV * kind.rtol
        assert (off <= estimated + closely).all() and off.max() <= kind.rtol
        assert estimated.max() <= kind.rtol


def other_skin(model):
    """Far from the model's own, and uneven where sheets may be."""
    waves, skin = np.array([1.0, 0.1, -0.1, 0.05][: model.modes]), model.parts.skin
    return Variation(
        1.1 * waves,
        (1.1 if model.circuit.fields == 1 else 0.7) * waves,
        np.full(len(skin.contacts), 0.8),
        np.linspace(0.5, 1.5, skin.pixels.rows * skin.pixels.columns).reshape(skin.pixels.shape),
        Loss(0.02),
        0.7,
    )


@kinds(left_out=BY_DEPTH)
def test_the_certificate_bounds_what_the_reduction_leaves_out(model, touches, name):
    own, worst = model.at(other_skin(model)), 0.0
    for cells, rises in [*touches, *drawn(model, 4)]:
        press = cells, np.where(cells < foam_parts(model.parts.skin), 5 * rises, rises)
        true = relative_difference(own.sweep(*press), own.exact(*press))
        bound = own.certificate(*press)
        assert (true <= bound + KRYLOV * KINDS[name].rtol + model.mesh_error).all()
        worst = max(worst, float(bound.max()))
    assert worst > 1e-3 * KINDS[name].rtol


@kinds()
def test_training_bounds_what_the_reduction_leaves_out_as_the_certificate_does(
    model, touches, name
):
    """Without the basis turned for each skin. By depth a certificate also covers the foam's c."""
    by_depth, closely = name in BY_DEPTH, 1e-3 * KINDS[name].rtol
    for variation in [None] if by_depth else [None, other_skin(model)]:
        own, cases = model.at(variation), [Case(variation, *press) for press in touches]
        found = largest_bounds(model, cases, model.frequency)
        expected = [own.certificate(case.cells, case.rises).max() for case in cases]
        if by_depth:
            assert (found <= np.array(expected) + closely).all()
        else:
            np.testing.assert_allclose(found, expected, rtol=0.01, atol=closely)


@kinds(left_out=["piezoresistive"])
def test_a_model_is_orthonormal_and_passive(model, touches, name):
    product = model.basis.T @ (model.family.space.K @ model.basis)
    np.testing.assert_allclose(product, np.eye(model.size), atol=1e-10)
    own = model.at(None)
    assert (own.unpressed_mass.diagonal >= 0).all()
    more = drawn(model, 20) if name not in BY_DEPTH else []
    Z = own.sweeps(PressBatch.of([*touches, *more]))
    assert (Z.real > 0).all()
    if name in TWO_TERMINALS:
        assert (parallel_capacitance(Z, model.parts.setup.frequency) > -1e-18).all()
        assert (np.diff(Z.real) < 0).all()


@kinds()
def test_a_model_comes_back_from_its_file_whole(library, name):
    before, after = library.stored(name)
    for each in ("unpressed", "pressed"):
        np.testing.assert_array_equal(after[each], before[each])
        np.testing.assert_allclose(after[f"bound {each}"], before[f"bound {each}"], rtol=1e-6)


@kinds()
def test_presses_have_equal_results_one_by_one_and_together(model, touches):
    own = model.at(None)
    for touched, Z in zip(touches, own.sweeps(PressBatch.of(touches)), strict=True):
        np.testing.assert_allclose(own.sweep(*touched), Z, rtol=1e-9)


@kinds(left_out=[*BY_DEPTH, "piezoresistive"], slow=DEAR)
def test_a_network_has_the_readings_of_a_model_of_these(library, touches, name):
    scene = library.scene(name)
    trained = library.reduce(
        scene.parts, ROUGH, same_sheets=False, readings=chain(scene.parts.skin)
    )
    own, batch = read(trained, scene.interfaces).at(None), PressBatch.of(touches)
    Z = Network(own).solve(batch, scene.frequencies).Z
    np.testing.assert_allclose(Z, own.sweeps(batch), rtol=1e-6)


@pytest.fixture
def values(moved):
    """Of all parameters that a kind may have, each away from where the scene has it."""
    return moved | {"body": 0.1, "rim": -0.1, "finger": 2e-12}


STEPS = {
    "lead_resistance": 1e-3,
    "lead_inductance": 1e-8,
    "stray_capacitance": 1e-15,
    "finger": 1e-14,
}
"""Of parameters that are no logarithms."""


@kinds(slow=DEAR)
def test_slopes_are_differences(library, touches, values, name):
    """Of applicators that meet slopes are those of each alone."""
    scene = library.scene(name)
    forward = library.forward(scene, rtol=KINDS[name].rtol if name in BY_DEPTH else ROUGH)
    if name in BY_DEPTH:
        coupled, foam = forward.reduced.family.rises.coupled, foam_parts(scene.parts.skin)
        touches = [touch for touch in touches if not coupled(touch[0][touch[0] < foam])]
    check_slopes(forward, touches, values, name in BY_DEPTH)


@kinds("a line")
def test_slopes_of_the_exact_line_are_differences(library, touches, values, name):
    scene = library.scene(name)
    model = Line(scene.parts.skin, scene.parts.setup)
    check_slopes(model, touches, values)


def check_slopes(forward, touches, values, by_depth=False):
    """By parameters and touches; of one press and of presses together.

    Of presses by depth together none is by a finger.
    """
    foam, own = (
        foam_parts(forward.skin),
        own_values(forward.skin, forward.setup),
    )
    values = {key: value for key, value in values.items() if key in own}

    def difference(step, *ends):
        up, down = (forward.slopes(TouchedCells(*touched), at).Z for *touched, at in ends)
        return (up - down) / (2 * step)

    for cells, rises in touches:
        found = forward.slopes(TouchedCells(cells, rises), values)
        by_touch = []
        for key, value in values.items():
            step = STEPS.get(key, 1e-4)
            ends = (values | {key: value + sign * step} for sign in (1, -1))
            same(found.by_parameter[key], difference(step, *((cells, rises, end) for end in ends)))
        for cell in cells:
            step = 1e-4 if cell < foam else 1e-14
            ends = (rises + sign * step * (cells == cell) for sign in (1, -1))
            expected = difference(step, *((cells, end, values) for end in ends))
            by_touch.append(expected)
            if cell < foam:
                same(found.by_rise[..., cell], expected)
        if by_depth and (cells >= foam).any():
            continue
        together = forward.slopes(PressBatch.of([(cells, rises)]), values)
        np.testing.assert_allclose(together.Z[0], found.Z, rtol=1e-9)
        for key, slope in found.by_parameter.items():
            same(together.by_parameter[key][0], slope)
        for k, slope in enumerate(by_touch):
            same(together.by_rise[0, ..., k], slope)


def same(found, expected):
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-8 * np.abs(expected).max())


SWEEPS = {
    "l with a hole": {},
    "uneven": {},
    "piezoresistive": {},
    "mesh": {},
    "walls of groups": {"dataset.press.finger": {"low": 0.0, "high": 5e-12}},
    "by depth": {
        "dataset.press.touches": [0.2, 0.4, 0.4],
        "dataset.press.depth": {"distribution": "uniform", "low": 0.3e-3, "high": 2.2e-3},
    },
}
"""What data sets of a kind draw."""


@kinds(*SWEEPS)
def test_a_data_set_has_the_sweeps_of_the_full_solver(library, tmp_path, name):
    """And presses every pixel that has skin."""
    rtol, scene = KINDS[name].rtol, library.scene(name).with_(ALIKE | SWEEPS[name])
    generate(
        DatasetPlan(scene.parts, 20 if name in BY_DEPTH else 40, 1, rtol), tmp_path / "set.zarr"
    )
    data = open_zarr(tmp_path / "set.zarr").load()
    pressed = {*zip(data["row"].values.tolist(), data["column"].values.tolist(), strict=True)}
    assert pressed - {(0, 0), (-1, -1)} == set(pixels_with_skin(scene.parts.skin))
    solver, bound = Solver(scene.parts, 0.1 * rtol), data.attrs["audit_bound"] + 0.1 * rtol
    for k in np.flatnonzero(data["touches"].values)[:3]:
        truth = solver.solve(
            press_on(scene.parts.skin, scene.press, str(data["press"].values[k]))
        ).Z
        assert relative_difference(impedance(data)[k], truth).max() <= bound <= 1.1 * rtol
