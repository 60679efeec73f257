"""A skin of one conductor over earth: a line between two ends, and touches that add capacitance."""

from functools import reduce

import numpy as np
import pytest
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, press_on
from rcskin.simulator.scene.scene_files import parse_scene

R, C, LENGTH = 0.5e6, 20e-12, 0.72
"""Resistance in ohm and capacitance to earth in F of the whole yarn, and its length in m."""
YARN = f"""
name = "yarn"
skin = {{length = {LENGTH}, width = 1e-3, bottom = "earth", top.sheet_resistance = {R * 1e-3 / LENGTH}, foam.capacitance_per_area = {C / (LENGTH * 1e-3)}}}
contact = [{{name = "left", edge = "left"}}, {{name = "right", edge = "right"}}]
interface = [{{name = "1", high = ["left"], low = "earth"}}, {{name = "2", high = ["right"], low = "earth"}}, {{name = "both", high = ["left", "right"], low = "earth"}}]
pixels = {{rows = 1, columns = 36}}
press = {{adds = "capacitance to earth", capacitance = 30e-12}}
sweep.frequencies = [1.0, 2e3, 25750.0, 1e6]
"""  # noqa: E501


@pytest.fixture(scope="module")
def yarn():
    return parse_scene(YARN, "yarn")


def chain(s, R, C):
    """[[cosh q, Zc sinh q], [sinh q / Zc, cosh q]] with q² = s R C, Zc² = R / (s C)."""
    q, Zc = np.sqrt(s * R * C), np.sqrt(R / (s * C))
    return np.array([[np.cosh(q), Zc * np.sinh(q)], [np.sinh(q) / Zc, np.cosh(q)]])


def with_point_touch(s, x, touch):
    """Z of the ends 1, 2 and of both tied, ohm, with a capacitor at the fraction x of the yarn."""
    point = np.array([[1, 0], [s * touch, 1]])
    (a, b), (c, d) = chain(s, x * R, x * C) @ point @ chain(s, (1 - x) * R, (1 - x) * C)
    return np.array([a / c, d / c, b / (a + d - 2)])


def solved(scene, text):
    return Solver(scene.parts, 1e-6).solve(press_on(scene.parts.skin, scene.press, text)).Z


@pytest.mark.parametrize("x", [0.1, 0.5, 0.83])
def test_a_narrow_touch_is_a_capacitor_between_two_chain_matrices(yarn, x):
    short = f"rect({x * LENGTH},0.0005,1e-6,0.001):30pF"
    expected = [with_point_touch(2j * np.pi * f, x, 30e-12) for f in yarn.frequencies[1:]]
    np.testing.assert_allclose(solved(yarn, short)[:, 1:], np.transpose(expected), rtol=1e-5)


@pytest.mark.parametrize("press", ["none", "1,1", "1,20:40pF+1,30:20pF", "1,36:0.4"])
def test_line_agrees_with_elements(yarn, press):
    resistive = yarn.with_({"contact.left.resistance": 50.0, "contact.right.resistance": 9.0})
    for scene in (yarn, resistive):
        frequency = scene.frequencies[:3]
        line, sheet = (
            Solver(scene.parts, 1e-6, model)
            .solve(press_on(scene.parts.skin, scene.press, press), frequency)
            .Z
            for model in ("line", "sheet")
        )
        np.testing.assert_allclose(line.real, sheet.real, rtol=2e-6)
        np.testing.assert_allclose(line.imag, sheet.imag, rtol=2e-6)


def test_both_ends_of_a_touched_yarn_are_mirror_images(yarn):
    here, there = solved(yarn, "1,7:25pF"), solved(yarn, "1,30:25pF")
    np.testing.assert_allclose(here[[1, 0, 2]], there, rtol=1e-12)


def test_at_low_frequency_all_capacitance_counts_and_both_ends_share_the_resistance(yarn):
    """Cp = C + touch from everywhere; an open line has Rs = R / 3, one fed at both ends R / 12."""
    cold = yarn.with_({"sweep.frequencies": [1e-3]})
    omega = 2 * np.pi * 1e-3
    touched = solved(cold, "1,11:30pF")[:, 0]
    np.testing.assert_allclose((1 / touched).imag / omega, C + 30e-12, rtol=1e-9)
    bare = solved(cold, "none")[:, 0]
    np.testing.assert_allclose(bare.real, [R / 3, R / 3, R / 12], rtol=1e-9)


def test_at_high_frequency_each_end_is_an_infinite_line_and_a_far_touch_is_not_seen(yarn):
    """Z = sqrt(R / (s C)), half of it for both ends; here exp(-q) is 1e-34, q² = s R C."""
    hot = yarn.with_({"sweep.frequencies": [2e8]})
    infinite = np.sqrt(R / (2j * np.pi * 2e8 * C))
    for press in ("none", "1,18:40pF"):
        expected = infinite * np.array([1, 1, 0.5])
        np.testing.assert_allclose(solved(hot, press)[:, 0], expected, rtol=1e-12)


def test_no_touch_and_sums_of_touches(yarn):
    np.testing.assert_array_equal(solved(yarn, "1,5:0pF"), solved(yarn, "none"))
    place = "rect(0.3,0.0005,0.02,0.001)"
    both = solved(yarn, f"{place}:12pF+{place}:18pF")
    np.testing.assert_allclose(both, solved(yarn, f"{place}:30pF"), rtol=1e-12)


def test_conductor_over_earth_is_a_sheet_over_a_perfect_conductor(yarn):
    """Two fields, with earth as a sheet of its own, agree with the one field."""
    short = yarn.with_({"skin.length": LENGTH / 12, "pixels.columns": 3})
    uneven = short.with_({"skin.top.map": {"kind": "gradient", "x": 1e-9}})
    for press in (Press(), press_on(short.parts.skin, short.press, "1,2:35pF")):
        two = Solver(uneven.parts, 1e-5).solve(press, yarn.frequencies[1:3]).Z
        np.testing.assert_allclose(
            two,
            Line(short.parts.skin, short.parts.setup).solve(press, yarn.frequencies[1:3]).Z,
            1e-4,
        )


def test_segments_of_a_network_may_be_joined_in_any_order(yarn):
    from rcskin.simulator.models.line import LinePorts, segment

    s = 2j * np.pi * np.array([1e-3, 1.0, 1e4, 1e9])
    parts = [segment(R * share, C * (1 - share), s) for share in (0.2, 0.5, 0.3)]
    left = reduce(LinePorts.joined, parts)
    right = parts[0].joined(parts[1].joined(parts[2]))
    np.testing.assert_allclose(np.stack(left), np.stack(right), rtol=1e-13)


def test_gains_of_both_ends_driven_at_once_are_those_of_the_chain_matrices(yarn):
    """V at the ends: Y V + (V - V_s) / R_s + V s C_in = 0 with Y of the chain, R_s = 1 Mohm."""
    Rs, Cin, x = 1e6, 8e-12, 0.3
    source = {"reader": "gain", "series_resistance": Rs, "load": {"capacitance": Cin}}
    ends = [
        {"name": one, "high": [one], "low": "earth", "driven_with": [other], **source}
        for one, other in (("left", "right"), ("right", "left"))
    ]
    read = yarn.with_({"interface": ends, "sweep.frequencies": [2e3, 25750.0]})
    found = solved(read, f"rect({x * LENGTH},0.0005,1e-6,0.001):30pF")
    for f, gains in zip(read.frequencies, found.T, strict=True):
        s = 2j * np.pi * f
        point = np.array([[1, 0], [s * 30e-12, 1]])
        (A, B), (_, D) = chain(s, x * R, x * C) @ point @ chain(s, (1 - x) * R, (1 - x) * C)
        Y = np.array([[D, -1], [-1, A]]) / B + np.eye(2) * (1 / Rs + s * Cin)
        np.testing.assert_allclose(gains, np.linalg.solve(Y, [1 / Rs, 1 / Rs]), rtol=1e-5)
