"""The error told of varied skins of any outline is kept, against other meshes and finer ones."""

import numpy as np
import pytest
from rcskin.simulator.fem.sweep import swept
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.square_meshes import Squares
from rcskin.simulator.models.heterogeneous.triangle_meshes import Triangles
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.frequency import laplace_variable

SIDE = 0.12
SHEETS = {"top": 6e4, "bottom": 4e4, "c": 5e-9, "length": SIDE, "width": SIDE}
SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * SIDE
L_SHAPE = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]) * SIDE / 2
HOLES = [
    {"circle": [0.06, 0.06, 0.012]},
    {"points": [[0.047, 0.05], [0.074, 0.055], [0.061, 0.075]]},
]
EDGES = ("left", "right", "bottom", "top")


def random_map(rng):
    match rng.integers(3):
        case 0:
            return {"kind": "gradient", "x": rng.uniform(-0.8, 0.8), "y": rng.uniform(-0.8, 0.8)}
        case 1:
            size = {"deviation": rng.uniform(0.05, 0.4), "seed": int(rng.integers(99))}
            return {"kind": "random", "correlation_length": rng.uniform(0.03, 0.06), **size}
        case _:
            return {"kind": "grid", "values": rng.uniform(0.5, 2, (3, 2)).tolist()}


def random_skin(rng, sides):
    """Keys of a skin; sides: corners of its outline, 0 for a rectangle."""
    skin = {}
    for layer in ("top", "bottom", "foam"):
        if rng.random() < 0.5:
            skin[f"{layer}.map"] = random_map(rng)
    for sheet in ("top", "bottom"):
        if rng.random() < 0.6:
            skin[f"{sheet}.anisotropy"] = {
                "ratio": 10 ** rng.uniform(0, 1),
                "angle": rng.uniform(0, np.pi),
            }
        skin[f"{sheet}.piezoresistance"] = rng.choice([0.0, rng.uniform(0, 3)])
    if sides:
        angle = 2 * np.pi * (np.arange(sides) + rng.uniform(0, 0.6, sides)) / sides
        points = np.stack([np.cos(angle), np.sin(angle)]) * rng.uniform(0.6, 1, sides)
        skin["outline"] = {"points": (SIDE / 2 * (1 + points.T)).tolist()}
        skin["outline"]["holes"] = HOLES[: int(rng.integers(2))]
    return skin


def random_foils(rng, sides):
    """One on each sheet, and perhaps one that floats."""
    foils = {}
    for sheet in ("top", "bottom", "top")[: int(rng.integers(2, 4))]:
        edge = f"outline.{rng.integers(1, sides + 1)}" if sides else rng.choice(EDGES)
        low = rng.uniform(0, 0.5)
        span = (0.0, 1.0) if rng.random() < 0.4 else (low, low + rng.uniform(0.2, 0.5))
        film = rng.choice([0.0, 10 ** rng.uniform(0, 2.5)])
        if f"{sheet}-{edge}" not in foils:
            foils[f"{sheet}-{edge}"] = {"span": span, "resistance": film}
    return foils


def random_press(rng):
    factor = rng.uniform(1.2, 5)
    return rng.choice(
        ["none", f"2,1:{factor}", f"rect(0.05,0.04,0.03,0.02):{factor}"]
        + [f"poly(0.04,0.05,0.08,0.055,0.06,0.075):{factor}"]
    ).item()


@pytest.fixture(scope="module")
def random_scene(varied, frequency_at):
    """A function of a seed and the corners of an outline to a scene, a press and frequencies."""

    def random_scene(seed, sides):
        rng = np.random.default_rng(seed)
        skin, foils, press = random_skin(rng, sides), random_foils(rng, sides), random_press(rng)
        scene = varied(skin, foils, rows=2, columns=2, **SHEETS)
        u = 10 ** rng.uniform(-3, 3)
        return scene, parse_press(press, 2.0), frequency_at(scene, u)

    return random_scene


def refined(kind, scene, press, f, rtol):
    """The first rung of a kind of mesh that keeps the tolerance, and Z of its finer elements."""
    circuit = circuit_of(scene.parts.skin, scene.parts.setup)
    found = kind(scene.parts.skin, circuit, press, rtol)
    while True:
        discretised = found.finer(f)
        rung = discretised.result(f, rtol)
        if rung.error.max() <= rtol:
            break
    fine, s = discretised.fine, laplace_variable(f, scene.skin.foam.loss)
    Y, _ = swept(fine.space, fine.system.mass, circuit.excitations, s, 1e-9)
    return rung, 1 / Y


def assert_kept(rung, Z, rtol, off):
    true = off(rung.Z, Z)
    assert true.max() <= rtol
    assert (true <= 0.8 * rung.error + 1e-6).all()


@pytest.mark.parametrize("seed", [3])
def test_rectangles_of_squares_and_of_triangles(random_scene, off, seed):
    scene, press, f = random_scene(seed, 0)
    plain = press if press.plain else parse_press("rect(0.05,0.04,0.03,0.02):3", 2.0)
    (_, of_squares), (_, of_triangles) = (
        refined(kind, scene, plain, f, 1e-4) for kind in (Squares, Triangles)
    )
    for rtol in (1e-2, 1e-3):
        assert_kept(refined(Triangles, scene, plain, f, rtol)[0], of_squares, rtol, off)
        assert_kept(refined(Squares, scene, plain, f, rtol)[0], of_triangles, rtol, off)


@pytest.mark.parametrize("seed", [100, pytest.param(104, marks=pytest.mark.slow)])
def test_outlines_of_any_shape(random_scene, off, seed):
    scene, press, f = random_scene(seed, 4 + seed % 5)
    _, Z = refined(Triangles, scene, press, f, 1e-4)
    for rtol in (1e-2, 1e-3):
        assert_kept(refined(Triangles, scene, press, f, rtol)[0], Z, rtol, off)


@pytest.mark.parametrize("angle", [None, 0.8, pytest.param(-0.8, marks=pytest.mark.slow)])
def test_a_foil_that_ends_at_an_inner_corner(varied, off, angle):
    """The worst of singularities: r^(1/3), and less where the sheet conducts along a direction."""
    skin = {"outline.points": L_SHAPE.tolist()}
    if angle is not None:
        skin["top.anisotropy"] = {"ratio": 10.0, "angle": angle}
    scene = varied(skin, {"top-outline.3": {}, "bottom-outline.6": {}}, **SHEETS)
    f = np.array([1e2, 1e4])
    _, Z = refined(Triangles, scene, Press(), f, 9e-4)
    for rtol in (1e-1, 1e-2):
        assert_kept(refined(Triangles, scene, Press(), f, rtol)[0], Z, rtol, off)


def test_discs_on_sheets_that_are_gauges_are_solved_on_triangles(varied, off):
    """Of cells covered in part the strain would be too high: 1 - 1 / factor is no mean."""
    skin = {"top.piezoresistance": 2.0}
    scene = varied(skin, {"top-left": {}, "bottom-left": {}}, frequencies=[1e4], **SHEETS)
    corners = 0.01 * np.exp(2j * np.pi * np.arange(64) / 64) * (2 * np.pi / 64) ** 0.5
    corners = corners / np.sin(2 * np.pi / 64) ** 0.5 + 0.03 + 0.05j
    polygon = ",".join(f"{z.real:.12f},{z.imag:.12f}" for z in corners)
    Z = [
        Solver(scene.parts, 1e-4).solve(parse_press(text, 2.0)).Z
        for text in ("disc(0.03,0.05,0.01):3", f"poly({polygon}):3")
    ]
    assert off(*Z).max() < 2e-4


TIGHT = [pytest.param(rtol, marks=pytest.mark.slow) for rtol in (1e-3, 1e-4)]


@pytest.mark.parametrize("rtol", [1e-2, *TIGHT])
def test_where_a_foil_ends_the_estimated_error_is_near_the_true_one(varied, off, rtol):
    """A singularity that no order follows shows but a part of itself."""
    foils = {"top-outline.1": {"span": (0.2, 0.6)}, "bottom-outline.3": {"span": (0.3, 0.9)}}
    scene = varied({"outline": {"points": SQUARE.tolist()}}, foils, **SHEETS)
    found, truth = (Solver(scene.parts, each).solve(Press()) for each in (rtol, rtol / 30))
    true = off(found.Z, truth.Z)
    told = np.stack(found.relative_errors)
    assert (told >= true).all()
    assert told.max() <= 6 * true.max()
