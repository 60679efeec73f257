"""Estimates for spread presses cover the errors of mechanics and of its integrals."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.fem.galerkin import Galerkin
from rcskin.simulator.fem.sweep import swept
from rcskin.simulator.models.heterogeneous.coefficients import raised_by_deflection
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.pressed_system import pressed_system
from rcskin.simulator.models.heterogeneous.triangle_meshes import Triangles
from rcskin.simulator.models.mechanics.indentation import deformation
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.sweeps import parallel_capacitance

PARTS = 6
CLOSED = 0.67 * 4e-3
"""Depth at which the cells are closed, m."""


def integral(found):
    """Integral of the factor less 1 over the skin, m², on divided triangles of the mechanics."""
    i, j = (each.ravel() for each in np.meshgrid(np.arange(PARTS), np.arange(PARTS)))
    upright, turned = i + j < PARTS, i + j < PARTS - 1
    third = np.repeat([1, 2], [upright.sum(), turned.sum()]) / 3
    a, b = (np.concatenate([each[upright], each[turned]]) + third for each in (i, j))
    sides = np.linalg.inv(found.w.inverse)
    x = found.w.origin[:, :, None] + np.einsum("tik,kp->itp", sides, np.stack([a, b]) / PARTS)
    area = np.abs(np.linalg.det(sides)) / 2
    return area @ (found.factor(x) - 1).mean(axis=1)


def impedance(found, coefficients, f):
    """Z in ohm with other coefficients on the same mesh."""
    elements = found.coarse.elements
    system = pressed_system(found.circuit, elements, coefficients)
    space = Galerkin(system, found.circuit, elements.order)
    return 1 / swept(space, system.mass, found.circuit.excitations, laplace_variable(f), 1e-10)[0]


@pytest.mark.parametrize("part", [0.95, pytest.param(0.995, marks=pytest.mark.slow)])
def test_capacitance_of_foam_that_nearly_closes(foam_scene, part):
    """At the edge of the applicator the deflection bends within a tenth of a mm."""
    scene = foam_scene(20.0, "elastomer", width=0.12)
    low = scene.sweep.model_copy(update={"frequencies": (1e-2,)})
    pixels = scene.pixels.model_copy(update={"rows": 5, "columns": 5})
    scene = scene.model_copy(update={"sweep": low, "pixels": pixels})
    press = parse_press(f"3,3:{1e3 * part * CLOSED}mm", 2.0)
    answer = Solver(scene.parts, 1e-4).solve(press)
    skin = scene.skin
    c, area = skin.foam.unpressed_capacitance_per_area, skin.length * skin.width
    true = c * (area + integral(deformation(scene.parts.skin, press, 5e-3)))
    Cp = parallel_capacitance(answer.Z, answer.frequency)
    assert (np.abs(Cp / true - 1) <= answer.relative_errors[1] + 2e-6).all()


@pytest.mark.parametrize("place", ["1,1", "1,2", "disc(0.02,0.02,0.01)"])
def test_the_effect_of_the_error_of_mechanics(foam_scene, place):
    """At each frequency, of a sheet that is a gauge too."""
    scene = foam_scene(20.0, "elastomer")
    top = scene.skin.top.model_copy(update={"piezoresistance": 2.0})
    scene = scene.model_copy(update={"skin": scene.skin.model_copy(update={"top": top})})
    press, f = parse_press(f"{place}:2.5mm", 2.0), np.array([1e1, 1e4, 1e6])
    circuit, coarse, close = (
        circuit_of(scene.parts.skin, scene.parts.setup),
        *(deformation(scene.parts.skin, press, e) for e in (1e-2, 1e-3)),
    )
    found = Triangles(scene.parts.skin, circuit, press, 1e-3, coarse).finer(f)
    felt = found.changes(raised_by_deflection(found.coefficients), f, 1e-5)
    other = replace(found.coefficients, pressed=close, _spread={})
    Z = [impedance(found, each, f) for each in (found.coefficients, other)]
    assert (relative_difference(*Z) <= felt + 1e-8).all()
    assert felt.max() < 1e-2
