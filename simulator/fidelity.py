"""The cheapest rung of the ladder that keeps the asked tolerance of Rs and Cp, and why.

Rungs: the exact line, one R and one C, two-dimensional elements for one field or for two. Elements
are refined until three resolutions agree; how fast they do is the error estimate of the finest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from simulator.circuit import Circuit, one_field, two_fields
from simulator.estimate import ROUNDING, remaining_error
from simulator.frequency import penetration_depth
from simulator.line import Line
from simulator.lumped import Lumped
from simulator.mesh import Resolution, singular_ends
from simulator.model import Model
from simulator.press import Press
from simulator.scene import Scene
from simulator.sheet import Sheet
from simulator.sweeps import InputError, ToleranceError, parallel_capacitance

ModelName = Literal["auto", "lumped", "line", "sheet"]
DEFAULT_RTOL = 1e-4
LOST_SUSCEPTANCE = 1e-9
SMOOTH_LADDER = [
    (1, 1),
    (2, 1),
    (3, 1),
    (4, 1),
    (5, 1),
    (6, 1),
    (8, 1),
    (10, 1),
    (8, 2),
    (10, 2),
    (10, 3),
]
SINGULAR_LADDER = [(order, 1) for order in range(1, 9)]


def checked_model(name: str) -> ModelName:
    """The same name, if it is one of a model; raises InputError."""
    for known in get_args(ModelName):
        if name == known:
            return known
    raise InputError(f"`model` must be one of {', '.join(get_args(ModelName))}, got {name!r}")


@dataclass(frozen=True)
class Answer:
    """Z of one press with the estimated errors of Rs and Cp; all of shape (interface, frequency).

    Z, Rs_error: ohm. Cp_error: F. model: the rung that gave it. rejected: cheaper rungs, and why
    they did not serve.
    """

    Z: NDArray[np.complex128]
    Rs_error: NDArray[np.float64]
    Cp_error: NDArray[np.float64]
    model: str
    rejected: tuple[str, ...] = ()


class Solver:
    """A scene at a tolerance: answers any press, refining as far as the tolerance needs."""

    def __init__(self, scene: Scene, rtol: float = DEFAULT_RTOL, model: ModelName = "auto") -> None:
        """rtol: largest relative error of Rs and of Cp. Raises InputError where it is not > 0."""
        if not (np.isfinite(rtol) and rtol > 0):
            raise InputError(f"`rtol` must be finite and > 0, got {rtol}")
        self.scene, self.rtol, self.model = scene, rtol, model
        self._level = 2
        self._sheets: dict[int, Sheet] = {}

    def solve(self, press: Press) -> Answer:
        """The answer of the cheapest rung that keeps the tolerance.

        Raises ToleranceError where none does, InputError where a model asked for by name does not
        apply to the scene or the press.
        """
        rungs: dict[str, Callable[[Press], Answer]] = {
            "line": self._line,
            "lumped": self._lumped,
            "sheet": self._sheet,
        }
        asked = list(rungs) if self.model == "auto" else [self.model]
        rejected: list[str] = []
        for name in asked:
            try:
                return replace(self._kept(rungs[name](press)), rejected=tuple(rejected))
            except (InputError, ToleranceError) as reason:
                if name == asked[-1]:
                    raise
                rejected.append(f"{name}: {reason}")
        raise AssertionError("the last rung answers or raises")

    def relative_errors(self, answer: Answer) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Estimated errors of Rs and Cp as fractions of their values.

        A susceptance below LOST_SUSCEPTANCE of |Y| is rounding; its error is told as a fraction of
        that: between foils of one sheet Cp may be nothing at all.
        """
        frequency = self.scene.frequencies
        Cp = np.abs(parallel_capacitance(answer.Z, frequency))
        lost = LOST_SUSCEPTANCE / np.abs(answer.Z) / (2 * np.pi * frequency)
        return answer.Rs_error / np.abs(answer.Z.real), answer.Cp_error / np.maximum(Cp, lost)

    def explain(self, press: Press, answer: Answer) -> str:
        """What answered a press, how far off it is by its own estimate, and what was rejected."""
        Rs, Cp = (errors.max() for errors in self.relative_errors(answer))
        chosen = f"{answer.model}; estimated error {Rs:.1e} of Rs, {Cp:.1e} of Cp"
        return "\n".join(
            [
                f"press {press}",
                f"  chosen    {chosen}, asked {self.rtol:g}",
                *(f"  rejected  {reason}" for reason in answer.rejected),
            ]
        )

    def _kept(self, answer: Answer) -> Answer:
        if not np.isfinite(answer.Z).all():
            raise ToleranceError(f"{answer.model} gave no finite impedance")
        worst = {}
        for name, errors in zip(("Rs", "Cp"), self.relative_errors(answer), strict=True):
            at = int(np.argmax(errors.max(axis=0)))
            worst[name] = (float(errors[:, at].max()), self.scene.frequencies[at])
        if max(error for error, _ in worst.values()) > self.rtol:
            told = " and ".join(
                f"{error:.1e} of {name} at {frequency:.4g} Hz"
                for name, (error, frequency) in worst.items()
            )
            raise ToleranceError(f"{answer.model}: estimated error {told}, asked {self.rtol:g}")
        return answer

    def _line(self, press: Press) -> Answer:
        Z = self._impedance(Line(self.scene), press)
        Cp = parallel_capacitance(Z, self.scene.frequencies)
        return Answer(Z, ROUNDING * np.abs(Z.real), ROUNDING * np.abs(Cp), "exact line")

    def _lumped(self, press: Press) -> Answer:
        self._kept(self._lumped_at_rest)
        return self._lumped_answer(press)

    @cached_property
    def _lumped_at_rest(self) -> Answer:
        return self._lumped_answer(Press())

    @cached_property
    def _lumped_models(self) -> list[Lumped]:
        return [Lumped(self.scene, self._circuit, each) for each in self._ladder[1:4]]

    def _lumped_answer(self, press: Press) -> Answer:
        Z = [self._impedance(model, press) for model in self._lumped_models]
        Rs_bound, Cp_bound = self._lumped_models[-1].bounds(press, self.scene.frequencies)
        resolved = self._resolved(*Z, model="one R and one C")
        return replace(
            resolved,
            Rs_error=resolved.Rs_error + Rs_bound,
            Cp_error=resolved.Cp_error + Cp_bound,
        )

    def _sheet(self, press: Press) -> Answer:
        Z = [self._impedance(self._sheet_at(self._level - back), press) for back in (2, 1)]
        while True:
            sheet = self._sheet_at(self._level)
            Z.append(self._impedance(sheet, press))
            fields = ("one field", "two fields")[self._circuit.fields - 1]
            told = f"2-D elements, {fields}, {sheet.resolution}, {sheet.unknowns} unknowns"
            try:
                return self._kept(self._resolved(Z[-3], Z[-2], Z[-1], told))
            except ToleranceError:
                if self._level + 1 == len(self._ladder):
                    raise
            self._level += 1

    def _impedance(self, model: Model, press: Press) -> NDArray[np.complex128]:
        return model.impedance(press, self.scene.frequencies)

    def _resolved(
        self,
        coarser: NDArray[np.complex128],
        coarse: NDArray[np.complex128],
        fine: NDArray[np.complex128],
        model: str,
    ) -> Answer:
        """The finest of three impedances, with the errors that their differences let expect."""
        Z = (coarser, coarse, fine)
        return Answer(
            fine,
            remaining_error(*(each.real for each in Z)),
            remaining_error(*(parallel_capacitance(each, self.scene.frequencies) for each in Z)),
            model,
        )

    def _sheet_at(self, level: int) -> Sheet:
        if level not in self._sheets:
            self._sheets[level] = Sheet(self.scene, self._circuit, self._ladder[level])
        return self._sheets[level]

    @cached_property
    def _circuit(self) -> Circuit:
        return one_field(self.scene) or two_fields(self.scene)

    @cached_property
    def _ladder(self) -> list[Resolution]:
        return ladder(self.scene, self._circuit)


def ladder(scene: Scene, circuit: Circuit) -> list[Resolution]:
    """Resolutions of increasing accuracy: by order, graded towards singular ends of foils.

    One layer more than the order leaves the error to the order, not to the tip of the foil. Next
    to contacted edges the cells are as fine as the field's layer at the highest frequency. No
    element spans the whole skin, which a plane of symmetry would halve: orders there come in pairs.
    """
    contacts = [contact for terminal in circuit.terminals for contact in terminal.contacts]
    singular = bool(singular_ends(contacts, scene.skin))
    skin = scene.skin
    layer = penetration_depth(
        scene.frequencies[-1],
        skin.top.sheet_resistance + skin.bottom.sheet_resistance,
        skin.foam.rest_capacitance_per_area * max(1.0, scene.press.capacitance_factor),
    )
    fewest = 2 if 1 in (scene.pixels.rows, scene.pixels.columns) else 1
    return [
        Resolution(order, max(cells, fewest), order + 1 if singular else 0, layer)
        for order, cells in (SINGULAR_LADDER if singular else SMOOTH_LADDER)
    ]
