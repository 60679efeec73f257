"""Air has none of the foam's loss, whichever model gives the answer."""

import numpy as np
import pytest
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.heterogeneous.elements_model import Elements
from rcskin.simulator.models.network_skin import Network
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.terminals import trained
from rcskin.simulator.press.batch import NOTHING, PressBatch
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.air_nodes import air_factor, air_nodes
from rcskin.simulator.scene.frequency import Loss, laplace_variable
from rcskin.simulator.sensor.mounted_skins import MountedSkins
from rcskin.simulator.sweeps import ToleranceError

RTOL = 1e-4
F = [1e-3, 1e-2]
"""Hz: each sheet has one potential."""
LOSSES = {
    "tan d": {"loss_tangent": 0.02},
    "relaxation": {"phase_exponent": 0.95},
    "leak": {"leak": 2e-3},
    "all": {"loss_tangent": 0.01, "phase_exponent": 0.97, "leak": 1e-3},
}
BODIES = [
    {"side": "top", "capacitance_per_area": 4e-9},
    {"side": "bottom", "capacitance_per_area": 2e-9},
]


@pytest.fixture(scope="module", params=LOSSES)
def lossy(request, around):
    given = {"low": "floating", "body": BODIES, "rim": 5e-12}
    return around(given, LOSSES[request.param], frequencies=F, columns=2)


def by_solver(model):
    return lambda scene: Solver(scene.parts, RTOL, model).solve(Press()).Z


def by_network(scene):
    network = Network(trained(scene.parts, RTOL).at(None))
    return network.solve(PressBatch.of([NOTHING]), scene.frequencies).Z[0]


def by_fields(scene):
    return (
        Elements(scene.parts.skin, scene.parts.setup)
        .fields(Press(), F, scene.interfaces[0].name, RTOL)
        .Z[None]
    )


def by_full_fields(scene):
    full = FullFields(scene.parts, F[-1], 1)
    return full.respond(np.ones(full.grid), {}, scene.frequencies).Z


MODELS = {
    "elements": by_solver("sheet"),
    "reduced": by_solver("reduced"),
    "auto": by_solver("auto"),
    "network": by_network,
    "forward": lambda scene: Forward(scene.parts, rtol=RTOL).slopes(NOTHING).Z,
    "fields": by_fields,
    "full fields": by_full_fields,
}


@pytest.mark.parametrize("model", MODELS)
def test_only_the_foam_has_the_loss(lossy, model):
    """Y = s C + j omega (C_t C_b / (C_t + C_b) + C_rim) of sheets at one potential each."""
    area, perimeter = 0.008, 0.36
    top, bottom = (body.per_area * area for body in lossy.surroundings.body)
    s = laplace_variable(lossy.frequencies, lossy.skin.foam.loss)
    foam = s * lossy.skin.foam.unpressed_capacitance_per_area * area
    air = 2j * np.pi * lossy.frequencies * (top * bottom / (top + bottom) + 5e-12 * perimeter)
    off = relative_difference(MODELS[model](lossy), 1 / (foam + air)[None])
    assert off.max() <= 3 * RTOL


def test_skins_that_a_sensor_draws_are_those_of_their_family(lossy):
    """Skins of different losses, solved together and each by itself."""
    skins = MountedSkins(lossy.parts, reduce(lossy.parts, RTOL), 0, range(3), True)
    press = PressBatch.of([(np.array([1]), np.array([0.5]))])
    each = np.stack([skin.sweeps(press)[0, 0] for skin in skins._skins])
    found = skins._impedances(press, slice(None), slice(None))
    assert relative_difference(found[:, 0], each).max() <= RTOL


def test_a_finger_is_in_air(around):
    """Rs of a finger that covers all of the touched sheet, above cut-off."""
    loss = {"loss_tangent": 0.05}
    cover = {"cover": {"thickness": 1e-3, "relative_permittivity": 3.0}}
    scene = around(cover, loss, columns=2, frequencies=[1e3, 1e5])
    body = around({"body": {"side": "top", "capacitance_per_area": 1e-9}}, loss, columns=2,
                  frequencies=[1e3, 1e5])  # fmt: skip
    press = parse_press("rect(0.05,0.04,0.1,0.08):1.0:8pF", 2.0, scene.parts.skin, scene.press)
    one, other = Solver(scene.parts, 1e-5).solve(press).Z, Solver(body.parts, 1e-5).solve(Press()).Z
    assert relative_difference(one, other).max() <= 2e-5


@pytest.mark.parametrize("loss", [Loss(0.02), Loss(0.3), Loss(0.0, 0.9), Loss(0.01, 0.97, 50.0)])
def test_nodes_interpolate_within_their_tolerance(loss):
    """Against a line of foam beside air, whose p is known."""
    f = np.geomspace(1e3, 2e5, 20)
    s, air = laplace_variable(f, loss), air_nodes(f, loss, 1e-6)

    def line(p):
        squared = s * 1e-6 * (1 + 0.7 * p)
        return np.sqrt(squared) * np.tanh(np.sqrt(squared))

    exact, found = (1 / Y for Y in (line(air_factor(f, loss)), air.mean(map(line, air.factors))))
    assert relative_difference(found, exact).max() <= 1e-6


def test_foam_that_conducts_too_much_is_solved_by_elements(around):
    """Each frequency by itself, where no few real answers suffice."""
    given = {"low": "floating", "body": BODIES}
    scene = around(given, {"loss_tangent": 3.0}, frequencies=F, columns=2)
    with pytest.raises(ToleranceError, match="the foam conducts too much"):
        air_nodes(scene.frequencies, scene.skin.foam.loss, RTOL)
    Z = Solver(scene.parts, RTOL).solve(Press()).Z
    top, bottom = (body.per_area * 0.008 for body in scene.surroundings.body)
    s = laplace_variable(scene.frequencies, scene.skin.foam.loss)
    air = 2j * np.pi * scene.frequencies * top * bottom / (top + bottom)
    exact = 1 / (s * scene.skin.foam.unpressed_capacitance_per_area * 0.008 + air)
    assert relative_difference(Z, exact[None]).max() <= RTOL
