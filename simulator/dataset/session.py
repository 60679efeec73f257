"""One session of a data set: its skin, presses, sweeps as the meter shows them, and audit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.dataset.audit import Audit, audited
from simulator.dataset.model import Family
from simulator.dataset.plan import Plan
from simulator.dataset.presses import Presses, drawn_presses
from simulator.dataset.skins import DrawnSkin, drawn_skin
from simulator.dataset.streams import AUDIT, METER, PRESSES, stream
from simulator.readout import Meter, displayed
from simulator.scene import Scene
from simulator.sweeps import parallel_capacitance


@dataclass(frozen=True)
class Drawn:
    """A session: its number, skin, meter and presses, what is shown of them, and the audit.

    shown: Rs [ohm], X [ohm], Cp [F], each of shape (press, interface, frequency).
    """

    number: int
    skin: DrawnSkin
    meter: Meter
    presses: Presses
    shown: dict[str, NDArray[np.float64]]
    audit: Audit


def drawn_session(plan: Plan, family: Family, number: int) -> Drawn:
    """A whole session, also where the data set ends within it."""
    scene, seed = plan.scene, plan.seed
    skin = drawn_skin(scene, seed, number, family.grid, family.modes)
    random = stream(seed, number, PRESSES)
    presses = drawn_presses(scene, random, plan.session_sweeps, family.grid)
    model = family.skin(skin.variation)
    Z, audit = audited(model, presses, stream(seed, number, AUDIT), number, plan.rtol)
    frequency = scene.frequencies
    meter = Meter(scene.readout, len(scene.interfaces), stream(seed, number, METER))
    measured = meter.measure(skin.leads.seen_through(Z, frequency))
    return Drawn(number, skin, meter, presses, _shown(scene, measured), audit)


def _shown(scene: Scene, Z: NDArray[np.complex128]) -> dict[str, NDArray[np.float64]]:
    values = {"Rs": Z.real, "X": Z.imag, "Cp": parallel_capacitance(Z, scene.frequencies)}
    digits = scene.readout.display_digits
    return {name: displayed(value, digits) for name, value in values.items()}
