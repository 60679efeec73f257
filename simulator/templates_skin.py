"""What is not known of a skin before it is measured, and what that does to a touch's change.

Sheets, foam, contacts and leads differ from session to session as the scene's [dataset.session]
draws them. A sweep against rest still shows some of it; to first order it is a sum of columns, one
for each unknown at one standard deviation.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from simulator.distribution import AnyDistribution
from simulator.family import Family
from simulator.forward import Forward
from simulator.frequency import laplace_variable
from simulator.observation import observed_slope
from simulator.parameters import leads_of, loss_of, own_values, variation_of
from simulator.scene import Scene
from simulator.variation import WAVES, mode_values

QUANTILES = (np.arange(512) + 0.5) / 512
NOWHERE = np.zeros(0, dtype=np.int64)


def expected(scene: Scene) -> dict[str, float]:
    """PARAMETERS of the skin and leads that sessions of the scene have in the mean."""
    session, own = scene.dataset.session, own_values(scene)
    return own | {
        "sheet_resistance": _logarithm(session.sheet_resistance)[0]
        + _logarithm(session.sheet_mismatch)[0],
        "capacitance": _logarithm(session.capacitance)[0],
        "contact_resistance": _logarithm(session.contact_resistance)[0],
        "loss_tangent": own["loss_tangent"] + _moments(session.loss_tangent)[0],
        "lead_resistance": own["lead_resistance"] + _moments(session.lead_resistance)[0],
        "stray_capacitance": own["stray_capacitance"] + _moments(session.stray_capacitance)[0],
    }


def deviations(scene: Scene) -> dict[str, float]:
    """Standard deviations of PARAMETERS between sessions of the scene; 0 for those not drawn."""
    session = scene.dataset.session
    own_sheet = _logarithm(session.sheet_mismatch)[1]
    both = _logarithm(session.sheet_resistance)[1]
    film = _logarithm(session.contact_resistance)[1]
    return dict.fromkeys(own_values(scene), 0.0) | {
        "sheet_resistance": math.hypot(both, own_sheet / math.sqrt(2)),
        "sheet_mismatch": math.sqrt(2) * own_sheet,
        "capacitance": _logarithm(session.capacitance)[1],
        "contact_resistance": film / math.sqrt(len(scene.contacts)),
        "loss_tangent": _moments(session.loss_tangent)[1],
        "lead_resistance": _moments(session.lead_resistance)[1],
        "stray_capacitance": _moments(session.stray_capacitance)[1],
    }


class UnknownSkin:
    """The unknowns of a scene's skin, by their effect on what `observed` tells of a touch."""

    def __init__(self, forward: Forward) -> None:
        self.forward, self.values = forward, expected(forward.scene)
        self._deviations = deviations(forward.scene)
        self._waves = _wave_terms(forward)
        self._at_rest = self._columns(NOWHERE, np.zeros(0))

    def effect(self, cells: NDArray[np.int64], rises: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of one standard deviation of each on a touch against rest, shape (number, unknown)."""
        return self._columns(cells, rises) - self._at_rest

    def _columns(self, cells: NDArray[np.int64], rises: NDArray[np.float64]) -> NDArray[np.float64]:
        response = self.forward.respond(cells, rises, self.values)
        shared = [
            deviation * response.by_parameter[name]
            for name, deviation in self._deviations.items()
            if deviation > 0 and name in response.by_parameter
        ]
        foam = np.moveaxis(response.by_cell, -1, 0)
        dZ = np.concatenate(
            [
                np.reshape(shared, (-1, *response.Z.shape)),
                self._of_foam(foam, cells, rises),
                self._of_waves(cells, rises),
            ]
        )
        columns = [observed_slope(response.Z, each) for each in dZ]
        return np.reshape(columns, (-1, 2 * response.Z.size)).T

    def _of_foam(
        self, by_cell: NDArray[np.complex128], cells: NDArray[np.int64], rises: NDArray[np.float64]
    ) -> NDArray:
        """Of each pixel's capacitance, or of each slow wave of it."""
        scene = self.forward.scene
        session, pixels = scene.dataset.session, scene.pixels
        pressed = np.ones(pixels.rows * pixels.columns)
        np.add.at(pressed, cells, rises)
        pressed *= math.exp(self.values["capacitance"])
        changes = session.foam_spread * pressed[:, None, None] * by_cell
        if session.foam_pattern == "pixel":
            return changes if session.foam_spread else changes[:0]
        row, column = np.indices((pixels.rows, pixels.columns)) + 0.5
        centres = np.stack(
            [column * scene.skin.length / pixels.columns, row * scene.skin.width / pixels.rows]
        )
        waves = mode_values(scene, centres, len(WAVES))[1:].reshape(len(WAVES) - 1, -1)
        return np.tensordot(waves, changes, axes=1)

    def _of_waves(
        self, cells: NDArray[np.int64], rises: NDArray[np.float64]
    ) -> NDArray[np.complex128]:
        """Of each slow wave of the sheets' conductance, shape (wave, interface, frequency)."""
        forward, values = self.forward, self.values
        s = laplace_variable(forward.scene.frequencies, loss_of(values))
        skin = forward.reduced.skin(variation_of(forward.divided, values))
        solved = skin.solved(cells, rises, s)
        found = np.empty((len(self._waves), len(solved), len(s)), dtype=complex)
        stray = 2j * np.pi * forward.scene.frequencies * leads_of(values).stray_capacitance
        for i, (u, Y) in enumerate(solved):
            for k, term in enumerate(self._waves):
                found[k, i] = -((term @ u) * u).sum(axis=0) / (Y + stray) ** 2
        return found


def _wave_terms(forward: Forward) -> NDArray[np.float64]:
    """K of the waves at one standard deviation each, in the reduced model's coordinates.

    One field stands for both sheets: to first order, waves of each add by its share of resistance.
    """
    scene, reduced = forward.scene, forward.reduced
    family = Family(reduced.scene, reduced.circuit, reduced.resolution, len(WAVES))
    R = np.array([scene.skin.top.sheet_resistance, scene.skin.bottom.sheet_resistance])
    share = 1.0 if reduced.circuit.fields == 2 else float(np.hypot(*R) / R.sum())
    unevenness = scene.dataset.session.unevenness
    W = reduced.coordinates
    terms = [
        unevenness * share * family.space.sheet_energy(W, term)
        for k, term in enumerate(family.sheet_terms)
        if k % len(WAVES) and unevenness > 0
    ]
    return np.reshape(terms, (-1, W.shape[1], W.shape[1]))


def _moments(drawn: AnyDistribution) -> tuple[float, float]:
    """Mean and standard deviation."""
    values = drawn.at(QUANTILES)
    return float(values.mean()), float(values.std())


def _logarithm(drawn: AnyDistribution) -> tuple[float, float]:
    """Mean and standard deviation of the logarithm."""
    values = np.log(drawn.at(QUANTILES))
    return float(values.mean()), float(values.std())
