"""Fields in closed form: a rectangle fed along its left edge, flat or on a cylinder."""

import numpy as np
import pytest

from simulator.fields import Fields

LENGTH, WIDTH = 0.12, 0.08
R, C = 50e3, 4.861e-9
FREQUENCIES = (1e3, 1e4, 1e5)


def line_fields(frequencies=FREQUENCIES, n=(37, 25), depth=0.0, radius=None, corners=4):
    """V = cosh(g (L - x)) / cosh(g L): both sheets of R ohm/sq fed from x = 0.

    depth: m at the middle of a bump of deflection. radius: m, of a cylinder along y. corners: of a
    cell, 3 or 4.
    """
    x, y = (a.ravel() for a in np.meshgrid(*map(np.linspace, (0, 0), (LENGTH, WIDTH), n)))
    f = np.array(frequencies)
    s = 2j * np.pi * f[:, None]
    g = np.sqrt(s * C * 2 * R)
    V = np.cosh(g * (LENGTH - x)) / np.cosh(g * LENGTH)
    J = g * np.sinh(g * (LENGTH - x)) / np.cosh(g * LENGTH) / (2 * R)
    along = np.stack([J, np.zeros_like(J)], axis=1)
    bump = np.exp(-((x - 0.084) ** 2 + (y - 0.04) ** 2) / 0.01**2)
    bare = V[:, :1] / (J[:, :1] * WIDTH)
    return Fields(
        x=np.stack([x, y]),
        position=_position(x, y, radius),
        cells=_cells(*n, corners),
        frequency=f,
        Z=bare[:, 0],
        potential=np.stack([0.5 * V, -0.5 * V]),
        current=np.stack([along, -along]),
        power=R * np.abs(J) ** 2,
        by_rise_Rs=np.real(-s * C * V**2 * bare) * (1 - 2 * x / LENGTH),
        by_rise_Cp=np.real(V**2) / (LENGTH * WIDTH),
        capacitance=C * (1 + bump),
        factor=1 + bump,
        deflection=depth * bump,
    )


def _position(x, y, radius):
    if radius is None:
        return np.stack([x, y, np.zeros_like(x)])
    angle = (x - LENGTH / 2) / radius
    return np.stack([radius * np.sin(angle), y, radius * np.cos(angle)])


def _cells(nx, ny, corners):
    first = (np.arange(ny - 1)[:, None] * nx + np.arange(nx - 1)).ravel()
    quads = np.stack([first, first + 1, first + 1 + nx, first + nx])
    if corners == 4:
        return quads
    return np.hstack([quads[[0, 1, 2]], quads[[0, 2, 3]]])


@pytest.fixture
def fields():
    """A function that gives the fields; see `line_fields`."""
    return line_fields


@pytest.fixture
def scene(build_scene):
    """The skin of `line_fields`, 4 x 6 pixels."""
    return build_scene(
        length=LENGTH, width=WIDTH, top=R, bottom=R, c=C, rows=4, columns=6, frequencies=FREQUENCIES
    )
