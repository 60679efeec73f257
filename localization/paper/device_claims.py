"""The paper's statements about the devices and its analytic model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...simulator.models.line import HALF_POWER, PAPER_CONSTANT, interrogation_frequency
from ...simulator.scene.foam.foam import VACUUM_PERMITTIVITY
from ...simulator.scene.scene import Scene
from .claim import Claim, listed, near
from .paper_quantities import STATED_SHEET_RESISTANCE, capacitance_changes, totals

THICKNESS = 4e-3
SILICONE, POROSITY = 2.8, 0.67
PRESS_DEPTH = 2e-3
METER_RANGE = 40.0, 200e3


def claims(strips: Sequence[Scene], sheet: Scene) -> list[Claim]:
    """Statements about sheet resistance, capacitance, foam and interrogation frequencies."""
    strip = strips[-1]
    return [
        _constant(),
        *(_frequencies(scene) for scene in strips),
        _sheet_resistance(strip),
        _capacitances(strip, sheet),
        _foam(sheet),
        _press(strip),
        _meter(sheet),
    ]


def _constant() -> Claim:
    exact = np.log(HALF_POWER) ** 2 / np.pi
    return Claim(
        topic="Constant of the interrogation frequencies",
        source="III, Eq 6",
        paper=f"{PAPER_CONSTANT}",
        ours=f"{exact:.5f}",
        agrees=near(exact, PAPER_CONSTANT),
        rule="number",
        why="(ln sqrt 2)² / pi. Eqs 4 and 5 print sqrt(pi R C) f; Eq 6 follows only if the root "
        "covers f as well.",
    )


def _frequencies(strip: Scene) -> Claim:
    device, n = totals(strip), strip.pixels.columns
    ends = strip.skin.length * np.arange(1, n + 1) / n
    per_metre = device.R / strip.skin.length, device.C / strip.skin.length
    f = np.sort(interrogation_frequency(ends, *per_metre))
    return Claim(
        topic=f"Interrogation frequencies of the 1x{n} strip",
        source="III, Eq 6 with 50 kohm/mm and 108 fF/mm",
        paper=f"{listed(np.asarray(strip.frequencies), '.0f')} Hz",
        ours=f"{listed(f, '.1f')} Hz",
        agrees=near(f, strip.frequencies),
        rule="number",
        why="Eq 6 evaluated with the loop resistance and capacitance of the scene.",
    )


def _sheet_resistance(strip: Scene) -> Claim:
    f = strip.frequencies[-1]
    stated = strip.with_({"skin.sheet_resistance": STATED_SHEET_RESISTANCE})
    ours, theirs = (100 * capacitance_changes(scene, f) for scene in (strip, stated))
    loop, stated_loop = (totals(scene).R / strip.skin.length / 1e6 for scene in (strip, stated))
    return Claim(
        topic="Sheet resistance of the strip's electrodes",
        source="II: 50 kohm/sq; III: 50 kohm/mm",
        paper=f"50 kohm/sq would be {stated_loop:.1f} kohm/mm for both sheets in series, "
        f"not the stated {loop:.0f} kohm/mm",
        ours=f"{strip.skin.top.sheet_resistance / 1e3:.0f} kohm/sq per electrode",
        agrees=near(loop, stated_loop),
        rule="number",
        why=f"The two statements differ {loop / stated_loop:.0f} times. At {f / 1e3:.1f} kHz a "
        f"press of pixel 1 to 5 changes Cp by {listed(ours, '+.1f')} % with the loop of 50 "
        f"kohm/mm, and by {listed(theirs, '+.1f')} % with 50 kohm/sq: only the first separates the "
        "curves as figure 3 does.",
    )


def _capacitances(strip: Scene, sheet: Scene) -> Claim:
    of_sheet = sheet.skin.foam.unpressed_capacitance_per_area * strip.skin.width * 1e12
    of_strip = totals(strip).C / strip.skin.length * 1e12
    return Claim(
        topic="Capacitance of strip and sheet",
        source="figure 1: 70 pF; III: 108 fF/mm",
        paper=f"{of_strip:.0f} pF/m on a width of 20 mm",
        ours=f"{of_sheet:.1f} pF/m from the sheet's 70 pF",
        agrees=near(of_sheet, of_strip),
        rule="number",
        why="The same foam within the spread of two hand-cut devices. Each scene keeps its own "
        "value.",
    )


def _foam(sheet: Scene) -> Claim:
    area = sheet.skin.length * sheet.skin.width
    mixed = ((1 - POROSITY) * SILICONE ** (1 / 3) + POROSITY) ** 3
    expected = VACUUM_PERMITTIVITY * mixed * area / THICKNESS
    stated = totals(sheet).C
    needed = stated * THICKNESS / (VACUUM_PERMITTIVITY * area)
    return Claim(
        topic="Overall capacitance of the 120 x 120 x 4 mm³ skin",
        source="figure 1; II: 40 g silicone, 120 g sugar",
        paper=f"{stated * 1e12:.0f} pF",
        ours=f"{expected * 1e12:.0f} pF",
        agrees=near(expected, stated),
        rule="number",
        why=f"A foam of porosity {POROSITY} has a relative permittivity near {mixed:.2f} "
        f"(Looyenga mixing); 70 pF needs {needed:.1f}. Stray capacitance of leads or a thinner "
        "foam would explain it; the scenes take the stated value.",
    )


def _press(strip: Scene) -> Claim:
    plates = THICKNESS / (THICKNESS - PRESS_DEPTH)
    solid = 1 - POROSITY
    unpressed, pressed = (
        (share * SILICONE ** (1 / 3) + 1 - share) ** 3 for share in (solid, solid * plates)
    )
    return Claim(
        topic="A press of 2 mm doubles the capacitance",
        source="IV-A",
        paper="2",
        ours=f"{plates:.0f} to {plates * pressed / unpressed:.1f}",
        agrees=bool(plates <= strip.press.capacitance_factor <= plates * pressed / unpressed),
        rule="number",
        why="Half the thickness at constant permittivity doubles it; closing pores raise the "
        "permittivity and the factor with it. The scenes take 2.",
    )


def _meter(sheet: Scene) -> Claim:
    low, high = METER_RANGE
    return Claim(
        topic="Frequencies of the meter",
        source="IV-A, IV-D",
        paper="1 kHz to 200 kHz by a Hioki IM3253",
        ours=f"Hioki IM3523, {low:g} Hz to {high / 1e3:g} kHz",
        agrees=bool(low <= sheet.frequencies[0] and sheet.frequencies[-1] <= high),
        rule="number",
        why="No IM3253 is known; the IM3523 is Hioki's LCR meter of that description, and 200 kHz, "
        "where the paper's sweep ends, is its highest frequency.",
    )
