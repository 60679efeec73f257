"""Slopes of reduced models beside differences of their answers."""

import numpy as np
import pytest


def check_slopes(forward, cells, rises, moved):
    """Asserts that slopes by parameters and by touched cells are differences.

    cells: pixels, and beyond them the fingers on pixels, whose rises are in F. moved: values of the
    parameters.
    """
    pixels = np.prod(forward.reduced.scene.pixels.shape)
    found = forward.respond(cells, rises, moved)
    together = forward.respond_together(cells[None], rises[None], moved)

    def difference(step, *ends):
        up, down = (forward.respond(cells, *end).Z for end in ends)
        return pytest.approx((up - down) / (2 * step), rel=1e-5)

    for name, value in moved.items():
        step = 1e-14 if name == "finger" else 1e-4
        expected = difference(step, *((rises, {**moved, name: value + s * step}) for s in (1, -1)))
        assert found.by_parameter[name] == expected
        assert together.by_parameter[name][0] == expected
    for k, step in enumerate(np.where(cells < pixels, 1e-4, 1e-14)):
        own = step * (cells == cells[k])
        expected = difference(step, *((rises + s * own, moved) for s in (1, -1)))
        at_rest = forward.unpressed_factors(moved)[cells[k]]
        assert at_rest * together.by_cell[0, ..., k] == expected
        if cells[k] < pixels:
            assert at_rest * found.by_cell[..., cells[k]] == expected
