"""One skin of a family: how it differs from the scene's own, in what does not need a new mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.frequency import Loss
from simulator.scene import Scene
from simulator.sweeps import InputError

WAVES = ((0, 0), (1, 0), (0, 1), (1, 1))
"""Half waves along x and along y of the modes of a sheet's conductance; the first is its mean."""


@dataclass(frozen=True)
class Variation:
    """Factors on what a scene says of its skin.

    top, bottom: coefficients of `mode_values` in conductance over nominal, shape (mode,), 1 and
    zeros for the scene's own. films: conductance of each contact's resistance over nominal, shape
    (contact,); nothing at ideal ones. capacitance: of the foam at rest over nominal, shape (rows,
    columns). loss: as it is, not a factor.
    """

    top: NDArray[np.float64]
    bottom: NDArray[np.float64]
    films: NDArray[np.float64]
    capacitance: NDArray[np.float64]
    loss: Loss

    @property
    def alike(self) -> bool:
        """Whether both sheets vary over the skin in the same way."""
        top, bottom = self.top / self.top[0], self.bottom / self.bottom[0]
        return bool(np.allclose(top, bottom, rtol=1e-12, atol=1e-12))


def nominal(scene: Scene, modes: int = 1) -> Variation:
    """The scene as it stands."""
    uniform = np.eye(1, modes).ravel()
    return Variation(
        uniform,
        uniform,
        np.ones(len(scene.contacts)),
        np.ones((scene.pixels.rows, scene.pixels.columns)),
        scene.skin.foam.loss,
    )


def mode_values(scene: Scene, x: NDArray[np.float64], modes: int) -> NDArray[np.float64]:
    """cos(pi i x / L) cos(pi j y / W) for the first of WAVES, shape (mode, ...).

    x: positions in m, shape (2, ...). Raises InputError for more modes than there are.
    """
    if not 1 <= modes <= len(WAVES):
        raise InputError(f"`modes` must be between 1 and {len(WAVES)}, got {modes}")
    along, across = np.pi * x[0] / scene.skin.length, np.pi * x[1] / scene.skin.width
    return np.stack([np.cos(i * along) * np.cos(j * across) for i, j in WAVES[:modes]])
