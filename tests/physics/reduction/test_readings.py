"""One trained model of all terminals: any reading of it, as the full system gives it."""

import itertools

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.network_skin import Network
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.terminals import chain, read, trained
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.contacts import Interface
from rcskin.simulator.sweeps import InputError

RTOL = 1e-4
FOILS = {
    "top-left": {"span": (0.005, 1.0)},
    "bottom-left": {"span": (0.005, 1.0), "resistance": 900.0},
    "top-bottom": {"span": (0.005, 1.0), "resistance": 300.0},
    "bottom-bottom": {"span": (0.005, 1.0)},
}
READINGS = {
    "left": (["top-left"], ["bottom-left"]),
    "bottom": (["top-bottom"], ["bottom-bottom"]),
    "crossed": (["top-left"], ["bottom-bottom"]),
    "crossed back": (["top-bottom"], ["bottom-left"]),
    "tied": (["top-left", "top-bottom"], ["bottom-left", "bottom-bottom"]),
    "one sheet": (["top-left"], ["top-bottom"]),
    "three to one": (["top-left", "top-bottom", "bottom-left"], ["bottom-bottom"]),
}
PRESS, CELLS, RISES = "1,1:2.0+2,3:0.7", np.array([0, 5]), np.array([1.0, -0.3])
ONE_PRESS = PressBatch.of([(CELLS, RISES)])


def interfaces(named):
    return [Interface(name=name, high=high, low=low) for name, (high, low) in named.items()]


@pytest.fixture(scope="module")
def scene(make_scene):
    pairs = {"meter": ("top-left", "bottom-left")}
    bare = make_scene(FOILS, pairs, rows=2, columns=3)
    return bare.model_copy(update={"interfaces": tuple(interfaces(READINGS))})


@pytest.fixture(scope="module")
def model(scene):
    return trained(scene.parts, RTOL)


@pytest.fixture(scope="module")
def impedance(scene, model):
    return read(model, scene.interfaces).at(None).sweep(CELLS, RISES)


def relative_error(Z, truth, scene):
    return relative_difference(Z, truth).max()


def test_any_reading_is_that_of_the_full_solver(scene, impedance):
    """Films on floating foils included: they short the sheet along the foil."""
    truth = Solver(scene.parts, 1e-6).solve(parse_press(PRESS, 2.0)).Z
    assert relative_error(impedance, truth, scene) <= RTOL


def test_the_certificate_bounds_every_reading(scene, model):
    """Error of the reduction alone, against the same mesh without reduction."""
    skin = read(model, scene.interfaces).at(None)
    bound = skin.certificate(CELLS, RISES)
    given = skin.weights, skin.loss, skin.map_of(CELLS, RISES), RTOL, model.frequency
    excitations = skin.reduced.circuit.excitations
    exact, Z = skin.reduced.family.solved(*given, excitations)[0], skin.sweep(CELLS, RISES)
    off = relative_difference(Z, exact)
    assert (off <= bound + RTOL * 0.05).all()


def test_sides_of_a_reading_are_exchangeable(scene, model, impedance):
    swapped = interfaces({name: (low, high) for name, (high, low) in READINGS.items()})
    Z = read(model, swapped).at(None).sweep(CELLS, RISES)
    assert relative_error(Z, impedance, scene) <= RTOL * 0.05


def test_a_reading_of_its_own_trained_model_is_the_same(scene, impedance):
    alone = scene.model_copy(update={"interfaces": scene.interfaces[2:3]})
    Z = reduce(alone.parts, RTOL).at(None).sweep(CELLS, RISES)
    assert relative_error(Z, impedance[2:3], scene) <= RTOL


def test_every_pair_of_terminals_is_passive(scene, model):
    pairs = itertools.combinations(FOILS, 2)
    every = interfaces({f"{a} {b}": ([a], [b]) for a, b in pairs})
    Z = read(model, every).at(None).sweeps(ONE_PRESS)
    assert (Z.real > 0).all()


@pytest.mark.parametrize(("tops", "bottoms"), [(1, 1), (2, 2), (4, 1), (1, 3), (3, 2), (0, 3)])
def test_training_drives_every_terminal_by_one_fewer_readings(make_scene, tops, bottoms):
    """All of them are connected by readings, so that any reading is a sum of those."""
    edges = ("left", "right", "bottom", "top")
    names = [*(f"top-{edge}" for edge in edges[:tops])]
    names += [f"bottom-{edge}" for edge in edges[:bottoms]]
    foils = {name: {"span": (0.1, 0.9)} for name in names}
    readings = chain(make_scene(foils, rows=1, columns=1).parts.skin)
    together = {names[0]}
    for _ in readings:
        together |= {n for e in readings if {*e.high, *e.low} & together for n in (*e.high, *e.low)}
    assert together == set(names)
    assert len(readings) == len(names) - 1


def test_a_reading_of_unknown_contacts_is_refused(model):
    with pytest.raises(InputError, match="nowhere"):
        read(model, interfaces({"wrong": (["nowhere"], ["top-left"])}))


def test_a_network_gives_all_readings_at_once(scene, model):
    """One, two and so many touches that the kernel solves in the basis."""
    skin = read(model, scene.interfaces).at(None)
    cells, rises = np.array([0, 5, 1, 0, 1, 2, 3, 4, 5]), np.array([1.0, -0.4, 2.0, *[0.5] * 6])
    batch = PressBatch(cells, rises, np.array([0, 1, 3, 9, 9]))
    found = Network(skin).solve(batch, scene.frequencies).Z
    assert relative_error(found, skin.sweeps(batch), scene) <= 1e-6


def test_terminals_at_one_potential_are_in_parallel(scene, model):
    """Y of tied pairs is the sum over both terminals' currents, each at 1 V."""
    tied = interfaces({"tied": READINGS["tied"]})
    network = Network(model.at(None), tied)
    Y = network.terminals(ONE_PRESS, scene.frequencies)[0]
    tops = [k for k, foil in enumerate(scene.contacts) if foil.electrode == "top"]
    Z = network.solve(ONE_PRESS, scene.frequencies).Z[0, 0]
    current = Y[:, tops][:, :, tops].sum(axis=(1, 2))
    np.testing.assert_allclose(1 / Z, current, rtol=1e-9)
