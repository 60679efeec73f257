"""Presses on all cells of a grid: as the kernel rasterizes them, and by its readable twin."""

import numpy as np
from rcskin.simulator.press.capacitance import touched_box
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.press.touch import Disc
from rcskin.simulator.scene.planar import covered


def cell_map(skin, press, rows, columns):
    """c over its unpressed value on a uniform grid over the skin, shape (row, column)."""
    found = np.ones((rows, columns))
    cells, rises = touched_cells(skin, press, (rows, columns))
    found.ravel()[cells] += rises
    return found


def twin_map(skin, press, rows, columns):
    """As `cell_map`, touch by touch."""
    x, y = np.linspace(0, skin.length, columns + 1), np.linspace(0, skin.width, rows + 1)
    total = np.ones((rows, columns))
    for touch in press.touches:
        if isinstance(touch, Disc):
            part = disc_fraction(touch.x, touch.y, touch.radius, x, y)
        else:
            left, right, bottom, top = touched_box(skin, touch)
            part = np.multiply.outer(covered(bottom, top, y), covered(left, right, x))
        if press.adds:
            total += (touch.factor - 1) * part
        else:
            total *= (1 - part) + touch.factor * part
    return total


def disc_fraction(x, y, radius, columns, rows):
    """Fraction of each cell within the disc around (x, y), shape (row, column); all in m.

    columns, rows: ascending limits of the cells. The areas are exact except for rounding errors of
    1e-16 radius².
    """
    u, v = (columns - x) / radius, (rows - y) / radius
    areas = np.diff(np.diff(_area_below(u, v[:, None]), axis=0), axis=1)
    return np.clip(areas / np.multiply.outer(np.diff(v), np.diff(u)), 0.0, 1.0)


def _area_below(u, v):
    """Area of the unit disc where its coordinates are <= u and <= v.

    It is the integral of w(t) + clip(v, -w, w) over t from -1 to u, w(t) = sqrt(1 - t²).
    """
    u, v = np.clip(u, -1.0, 1.0), np.clip(v, -1.0, 1.0)
    w = np.sqrt(1 - v**2)
    remainder = _under_arc(np.minimum(u, -w)) + _under_arc(np.maximum(u, w)) - _under_arc(w)
    return _under_arc(u) + np.sign(v) * remainder + v * (np.clip(u, -w, w) + w)


def _under_arc(u):
    """Integral of sqrt(1 - t²) over t from -1 to u."""
    return (u * np.sqrt(1 - u**2) + np.arcsin(u)) / 2 + np.pi / 4
