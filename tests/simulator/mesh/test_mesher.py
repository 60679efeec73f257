"""Triangles of drawings: what they conform to, how they grow, and that they are always the same."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from rcskin.simulator.mesh.arcs import edge_numbers, edges_of
from rcskin.simulator.mesh.mesher import GROWTH, Sizing, divided, meshed, triangulated
from rcskin.simulator.mesh.skin_mesh import domain
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Disc
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import ToleranceError

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
AROUND = np.array([(0, 1), (1, 2), (2, 3), (3, 0)])


def drawing(inner, bends=()):
    """The unit square with a loop within it, which is no hole: points, pieces, curvature, curve."""
    first = len(SQUARE)
    number = np.arange(first, first + len(inner))
    pieces = np.concatenate([AROUND, np.stack([number, np.roll(number, -1)], axis=1)])
    curvature = np.zeros(len(pieces))
    curvature[len(AROUND) :] = bends or 0.0
    curve = np.where(np.arange(len(pieces)) < len(AROUND), 0, -1)
    return np.concatenate([SQUARE, inner]), pieces, curvature, curve


def circle(radius, centre=(0.4, 0.3), parts=16):
    angle = 2 * np.pi * np.arange(parts) / parts
    inner = centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return drawing(inner, -1 / radius)


def twice_areas(p, t):
    a, b, c = p.T[t]
    u, v = b - a, c - a
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]


@pytest.mark.parametrize("radius", [0.2, 1e-2, 1e-4, 1e-6])
def test_triangles_grow_from_what_is_small(radius, tools):
    found = meshed(*circle(radius), 0.2)
    assert twice_areas(found.p, found.t).min() > 0
    assert twice_areas(found.p, found.t).sum() == pytest.approx(2.0, rel=1e-12)
    assert tools.least_angle(found) > 20
    assert found.t.shape[1] < 6000
    on_circle = found.lines[:, found.piece >= len(AROUND)]
    off = np.linalg.norm(found.p[:, on_circle] - np.array([[[0.4]], [[0.3]]]), axis=0)
    assert off == pytest.approx(radius, rel=1e-9)


def test_every_line_is_an_edge_and_pieces_are_whole():
    found = meshed(*circle(0.1), 0.2)
    edges, _ = edges_of(found.t)
    assert (edge_numbers(found.lines, edges) >= 0).all()
    length = np.linalg.norm(np.diff(found.p[:, found.lines], axis=1)[:, 0], axis=0)
    assert np.bincount(found.piece, length)[: len(AROUND)] == pytest.approx(1.0, rel=1e-12)


def test_holes_are_left_out():
    points, pieces, curvature, curve = circle(0.2)
    found = meshed(points, pieces, 0 * curvature, np.where(curve < 0, 1, 0), 0.1)
    polygon = 16 * 0.2**2 / 2 * np.sin(2 * np.pi / 16)
    assert twice_areas(found.p, found.t).sum() / 2 == pytest.approx(1 - polygon, rel=1e-12)


def test_lengths_rise_no_faster_than_their_growth():
    points, pieces, *_ = circle(1e-3)
    sizing = Sizing(points, pieces, 0.3)
    along = np.stack([np.linspace(0.4, 1, 400), np.full(400, 0.3)], axis=1)
    found = sizing(along)
    assert found.max() <= 0.3
    assert np.abs(np.diff(found)).max() <= GROWTH * (along[1, 0] - along[0, 0]) * (1 + 1e-9)


def test_lines_are_as_long_as_requested():
    points, pieces, curvature, _ = circle(1e-3)
    sizing = Sizing(points, pieces, 0.3)
    p, lines, piece = divided(points, pieces, curvature, sizing)
    start, stop = p[lines]
    part = np.linalg.norm(stop - start, axis=1) / sizing((start + stop) / 2)
    assert part.max() < 1.1
    divisions = np.bincount(piece)
    assert (divisions[len(AROUND) :] == 1).all() and (divisions[: len(AROUND)] > 3).all()


def test_lines_that_cross_are_refused():
    lines = np.array([(0, 1, 2, 3, 0, 1), (1, 2, 3, 0, 2, 3)])
    with pytest.raises(ToleranceError, match="too near to others to mesh"):
        triangulated(SQUARE, lines, np.array([0, 0, 0, 0, -1, -1]))


def test_points_on_lines_are_refused():
    lines = np.array([(0, 1, 2, 3), (1, 2, 3, 0)])
    with pytest.raises(ToleranceError, match="too near to others to mesh"):
        triangulated(np.append(SQUARE, [(0.5, 0.0)], axis=0), lines, np.zeros(4))


def test_meshes_are_the_same_in_threads_and_processes(tools):
    path = tools.SCENES / "disc-with-hole.toml"
    press = Press((Disc(0.07, 0.07, 0.01, 2.0),))

    def bits(_):
        mesh = domain(load_scene(path).parts.skin, press, 0.01)
        return mesh.p.tobytes().hex() + mesh.t.tobytes().hex()

    with ThreadPoolExecutor(4) as pool:
        here = set(pool.map(bits, range(8)))
    script = f"""
from pathlib import Path
from rcskin.simulator.mesh.skin_mesh import domain
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Disc
from rcskin.simulator.scene.scene_files import load_scene
skin = load_scene(Path({str(path)!r})).parts.skin
mesh = domain(skin, Press((Disc(0.07, 0.07, 0.01, 2.0),)), 0.01)
print(mesh.p.tobytes().hex() + mesh.t.tobytes().hex())
"""
    there = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert here == {there.stdout.strip()}
