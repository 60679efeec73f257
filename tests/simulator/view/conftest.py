"""Fields in closed form: a rectangle fed along its left edge, flat or on a cylinder."""

import numpy as np
import pytest
from rcskin.simulator.models.solution import SolutionFields
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.view.scenery import ViewedPress

LENGTH, WIDTH = 0.12, 0.08
R, C = 50e3, 4.861e-9
FREQUENCIES = (1e3, 1e4, 1e5)


def line_fields(
    frequencies=FREQUENCIES, n=(25, 17), depth=0.0, radius=None, corners=4, apart=False
):
    """V = cosh(g (L - x)) / cosh(g L): both sheets of R ohm/sq fed from x = 0.

    depth: m, in the middle of a bump of deflection. radius: m, of a cylinder along y that the skin
    lies on. corners: of a cell, 3 or 4. apart: each cell has points of its own.
    """
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, LENGTH, n[0]), _across(n[1])))
    cells = _cells(*n, corners)
    if apart:
        x, y = x[cells].ravel(), y[cells].ravel()
        cells = np.arange(x.size).reshape(cells.shape)
    s = 2j * np.pi * np.array(frequencies)[:, None]
    g = np.sqrt(s * C * 2 * R)
    V = np.cosh(g * (LENGTH - x)) / np.cosh(g * LENGTH)
    J = g * np.sinh(g * (LENGTH - x)) / np.cosh(g * LENGTH) / (2 * R)
    along = np.stack([J, np.zeros_like(J)], axis=1)
    bump = np.exp(-((x - 0.084) ** 2 + (y - 0.04) ** 2) / 0.01**2)
    Z = 2 * R / (g * WIDTH * np.tanh(g * LENGTH))
    return SolutionFields(
        x=np.stack([x, y]),
        position=_position(x, y, radius),
        cells=cells,
        frequency=np.array(frequencies),
        Z=Z[:, 0],
        potential=np.stack([0.5 * V, -0.5 * V]),
        current=np.stack([along, -along]),
        power=R * np.abs(J) ** 2,
        by_rise_Rs=np.real(s * C * V**2 * Z**2) / -Z.real,
        by_rise_Cp=np.imag(s * C * V**2) / np.imag(1 / Z),
        capacitance=C * (1 + bump),
        factor=1 + bump,
        deflection=depth * bump,
    )


def _across(n):
    return np.linspace(0, WIDTH, n)


def _position(x, y, radius):
    if radius is None:
        return np.stack([x, y, np.zeros_like(x)])
    angle = (x - LENGTH / 2) / radius
    return np.stack([LENGTH / 2 + radius * np.sin(angle), y, radius * (np.cos(angle) - 1)])


def _cells(nx, ny, corners):
    first = (np.arange(ny - 1)[:, None] * nx + np.arange(nx - 1)).ravel()
    quads = np.stack([first, first + 1, first + 1 + nx, first + nx])
    if corners == 4:
        return quads
    return np.sort(np.hstack([quads[[0, 1, 2]], quads[[0, 2, 3]]]), axis=0)


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """Pictures of fewer pixels, drawn in less time."""
    monkeypatch.setattr("rcskin.simulator.view.figure.PIXELS_PER_INCH", 80)


@pytest.fixture
def fields():
    """A function that gives the fields; see `line_fields`."""
    return line_fields


@pytest.fixture
def scene(make_scene):
    """A function that gives the skin of `line_fields`, 4 x 6 pixels, with further keys of skins."""

    def scene(**more):
        plain = make_scene(
            length=LENGTH, width=WIDTH, top=R, bottom=R, c=C, rows=4, columns=6,
            frequencies=FREQUENCIES,
        )  # fmt: skip
        tables = plain.model_dump(by_alias=True, exclude_none=True)
        tables["skin"].update(more)
        return type(plain).model_validate(tables)

    return scene


@pytest.fixture
def stage(scene):
    """A function that sets up fields under a press of pixel (3, 5)."""

    def stage(fields, press="3,5", wrapped=None, exaggeration=None, **skin):
        there = scene(**skin)
        pressed = parse_press(press, 2.0)
        return ViewedPress(
            there.parts,
            pressed,
            there.interfaces[0],
            fields,
            wrapped,
            exaggeration,
        )

    return stage
