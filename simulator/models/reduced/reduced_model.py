"""Reduced model: the impedance of any skin of a scene's family, under any press."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Mask, Real
from ...press.batch import PressBatch, TouchedCells
from ...press.press import Press, press_on
from ...press.rasterized import needs_factors, touched_cells
from ...report.findings import DataTable, Findings, Result
from ...scene.parts import SceneParts, Setup, Skin
from ...sweeps import InputError
from ..model import GivenPress, Model, Presses
from ..parameters import Variation
from ..solution import Answer, ModelResult
from .pixel_presses import applied
from .projection import Projection
from .reduced_skin import KRYLOV_SHARE, ReducedSkin
from .touches import spreads


def pressed_cells(parts: SceneParts, press: Press) -> TouchedCells:
    """Cells that a press touches, see `touched_cells`, for a model of presses as of the scene.

    Raises InputError also for a depth that tension spreads, if the scene presses by factors.
    """
    if press.indented and spreads(parts.skin) and parts.plan.press.by_factor:
        raise needs_factors(press)
    return touched_cells(parts.skin, press)


@dataclass(frozen=True, repr=False)
class Reduced(Projection, Result, Model):
    """Reduced model of a scene's family of skins and presses."""

    name, seconds = "reduced", 5e-6

    @property
    def skin(self) -> Skin:
        """The scene's own skin."""
        return self.parts.skin

    @property
    def setup(self) -> Setup:
        """Interfaces and frequencies of the scene."""
        return self.parts.setup

    def refuses(self, press: GivenPress) -> str | None:
        """See `Domain`; the certificate says where the model is not accurate."""
        return None

    def solve(
        self,
        press: Presses | str,
        frequency: Real | None = None,
        rtol: float | None = None,
        certify: bool = True,
    ) -> Answer:
        """Answer for the scene's own skin, with its certified error, which includes the mesh.

        press: a press, its text, or a batch of pixels. A touch that is no whole pixel counts in
        each pixel by the area that it covers there. frequency: Hz, by default those of the scene;
        the error is infinite beyond those of the training. rtol: by default its own. certify: False
        leaves the error out, which takes longer than the answer. Raises InputError for a text that
        is no press on the scene.
        """
        f = self.setup.frequency if frequency is None else frequency
        if isinstance(press, str):
            press = press_on(self.skin, self.parts.plan.press, press)
        rtol = self.rtol if rtol is None else rtol
        if isinstance(press, PressBatch):
            return self._batch(press, f, certify)
        touched, uncertainty = self._pressed(self._given(press, rtol))
        within, (low, high) = self._trained_at(f), self.frequency[[0, -1]]
        Z = np.empty((len(self._own.combination.weights), len(f)), dtype=np.complex128)
        for some in filter(np.any, (within, ~within)):
            Z[:, some] = self._own.sweep(*touched, f[some])
        served = ((self._description, self.size),) * len(f)
        if not certify:
            return Answer(Z, None, served)
        error = np.full((2, *Z.shape), np.inf)
        rejected, stopped = [], None
        if within.any():
            bound = self._own.certificate(*touched, f[within]) + KRYLOV_SHARE * self.rtol
            error[:, :, within] = bound + self.mesh_error + uncertainty
            result = ModelResult(self._description, self.size, Z[:, within], error[:, :, within])
            if (result.error > rtol).any():
                rejected.append(result.shortfall(f[within], rtol))
        if not within.all():
            beyond = ", ".join(f"{each:g}" for each in f[~within])
            stopped = InputError(
                f"the model is trained for frequencies from {low:g} to {high:g} Hz, got {beyond}"
            )
        return Answer(Z, error, served, tuple(rejected), stopped)

    def at(self, variation: Variation | None, pressed: Real | None = None) -> ReducedSkin:
        """One skin of the family; the scene's own skin if `variation` is None.

        pressed: see `ReducedSkin`. Raises InputError if the fields of the family cannot represent
        the variation.
        """
        return ReducedSkin(self, variation, pressed)

    @cached_property
    def _own(self) -> ReducedSkin:
        return self.at(None)

    @property
    def _description(self) -> str:
        return f"reduced to {self.size} vectors, {self.circuit.description}"

    def _batch(self, presses: PressBatch, frequency: Real, certify: bool) -> Answer:
        Z, served = self._own.sweeps(presses, frequency), ((self._description, self.size),)
        if not certify:
            return Answer(Z, None, served * len(frequency))
        bounds = [self._own.certificate(*each, frequency) for each in presses.each()]
        error = np.stack(bounds, axis=1) + KRYLOV_SHARE * self.rtol + self.mesh_error
        error[..., ~self._trained_at(frequency)] = np.inf
        return Answer(Z, error, served * len(frequency))

    def _trained_at(self, frequency: Real) -> Mask:
        """True for frequencies in Hz between those of the training."""
        return (self.frequency[0] <= frequency) & (frequency <= self.frequency[-1])

    def _pressed(self, press: GivenPress) -> tuple[TouchedCells, float]:
        """Cells that a press touches, and relative uncertainty of their factors."""
        spread = press.press.indented and spreads(self.skin)
        if spread and self.touches.spread:
            return applied(self, press)
        known = press.press if spread else press.uniform or press.sharp
        return pressed_cells(self.parts, known), 0.0

    @property
    def report(self) -> Findings:
        """Size and errors of the model; curves of a few presses."""
        from .curves_chart import curves_chart

        rows, columns = self.grid
        numbers = f"{self.size}", f"{rows} x {columns}", f"{self.rtol:g}", f"{self.mesh_error:.1e}"
        header = "size of the basis", "pixels", "rtol", "estimated error of the mesh"
        title = f"Reduced model of {self.parts.skin.name}"
        return Findings(
            title, [DataTable("model", header, [numbers])], small=lambda: curves_chart(self)
        )
