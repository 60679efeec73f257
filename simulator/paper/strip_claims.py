"""What the paper states of the 1xn strip."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simulator.paper.claim import Claim, listed, neighbour_errors, same_proportion, share
from simulator.paper.localizer import Confusion
from simulator.paper.reading import (
    capacitance_changes,
    low_frequency_resistances,
    open_line_frequencies,
    paper_frequencies,
)
from simulator.paper.rehearsal import STRIPS, Rehearsal

REPORTED = {"strip-1x3": (24, 24), "strip-1x4": (24, 24), "strip-1x5": (29, 30)}
LOW = 1.0


def claims(rehearsals: Mapping[str, Rehearsal], confusions: Mapping[str, Confusion]) -> list[Claim]:
    """Statements about the curves of figure 3 and its confusion matrices."""
    strip = rehearsals["strip-1x5"]
    return [
        _equal_at_low_frequency(strip),
        _first_pixel(strip),
        _beyond_cutoff(strip),
        _cutoffs(strip),
        *(_accuracy(name, confusions[name]) for name in STRIPS),
        _confused_pixels(confusions["strip-1x5"]),
    ]


def _equal_at_low_frequency(strip: Rehearsal) -> Claim:
    changes = 100 * capacitance_changes(strip.scene, LOW)
    at_lowest = 100 * capacitance_changes(strip.scene, strip.scene.frequencies[0])
    R = low_frequency_resistances(strip.scene) / 1e6
    return Claim(
        topic="At low frequency Cp does not depend on which pixel is pressed",
        source="IV-C, figure 3",
        paper="the same for all pixels",
        ours=f"dCp/Cp {listed(changes, '+.2f')} % at {LOW:g} Hz",
        agrees=bool(np.ptp(changes) < 0.1),
        why=f"Cp(0) is the total capacitance. At the lowest interrogation frequency, "
        f"{strip.scene.frequencies[0]:.0f} Hz, it is {listed(at_lowest, '+.1f')} % already. And Rs "
        f"tells the pixel even at zero frequency: {R[0]:.4f} Mohm at rest, {listed(R[1:], '.4f')} "
        "Mohm with pixel 1 to 5 pressed.",
    )


def _first_pixel(strip: Rehearsal) -> Claim:
    first = [100 * capacitance_changes(strip.scene, f)[0] for f in strip.scene.frequencies]
    return Claim(
        topic="Pixel 1 raises the capacitance at all interrogation frequencies",
        source="IV-C",
        paper="larger than unpressed",
        ours=f"dCp/Cp {listed(first, '+.1f')} %",
        agrees=bool(min(first) > 0),
        why="The field always reaches the pixel next to the interface.",
    )


def _beyond_cutoff(strip: Rehearsal) -> Claim:
    f = strip.scene.frequencies[-1]
    changes = 100 * capacitance_changes(strip.scene, f)
    return Claim(
        topic="Above its cut-off a distant pixel is not seen",
        source="IV-C",
        paper="no change",
        ours=f"dCp/Cp {listed(changes, '+.1f')} % at {f / 1e3:.1f} kHz, pixel 1 to 5",
        agrees=bool(np.abs(changes[1:]).max() < 1),
        why="It is seen, with the other sign: a distant capacitance is charged through the sheets' "
        "resistance, and the larger it is the more it turns current from capacitive to resistive. "
        "Pixels 4 and 5 are nearly equal, as reported.",
    )


def _cutoffs(strip: Rehearsal) -> Claim:
    infinite, finite = paper_frequencies(strip.scene), open_line_frequencies(strip.scene)
    return Claim(
        topic="Half-power frequencies at the pixels' ends",
        source="III, figure 2(c)",
        paper=f"{listed(infinite, '.0f')} Hz",
        ours=f"{listed(finite, '.0f')} Hz",
        agrees=bool(np.allclose(infinite, finite, rtol=0.05)),
        why="Eqs 4-6 take the wave of an infinite line. The strip ends: what its open end reflects "
        "holds the amplitude up, and all pixels but the first lose half their power at nearly one "
        "frequency.",
    )


def _accuracy(name: str, confusion: Confusion) -> Claim:
    right, total = REPORTED[name]
    return Claim(
        topic=f"Accuracy of the {name.removeprefix('strip-')} strip",
        source="IV-C, figure 3",
        paper=f"{100 * right / total:.1f} %",
        ours=share(confusion),
        agrees=same_proportion(right, total, confusion),
        why="With the scene's noise of 0.3 % and 0.15 degrees and 10 % spread between presses, "
        "which the paper does not state. Agreement: Fisher's exact test on so many sweeps.",
    )


def _confused_pixels(confusion: Confusion) -> Claim:
    beside, wrong = neighbour_errors(confusion)
    changes = f"{beside} of {wrong} errors between neighbours"
    return Claim(
        topic="Which pixels of the 1x5 strip are confused",
        source="IV-C",
        paper="the 4th and 5th",
        ours=changes if wrong else "no error",
        agrees=beside == wrong,
        why="Neighbours far from the interface have the closest curves; which of the few close "
        "calls goes wrong is the noise's choice.",
    )
