"""The paper's statements about the 1xn strip."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...simulator.arrays import Integer
from ..evaluation.confusion import Confusion
from .claim import ENOUGH, Claim, listed, mean_share, near, noise_of, same_proportion, share
from .paper_quantities import (
    capacitance_changes,
    low_frequency_resistances,
    open_line_frequencies,
    paper_frequencies,
)
from .results import Results
from .simulated_experiment import STRIPS, SimulatedExperiment
from .studies import DRAWS

if TYPE_CHECKING:
    import xarray as xr

REPORTED = {"strip-1x3": (24, 24), "strip-1x4": (24, 24), "strip-1x5": (29, 30)}
LOW = 1.0


def claims(results: Results) -> list[Claim]:
    """Statements about the curves and confusion matrices of figure 3; curves of the 1x5 strip."""
    strip, confusions, noise = results.experiments["strip-1x5"], results.confusions, results.noise
    readout = strip.scene.readout
    return [
        _equal_at_low_frequency(strip),
        _first_pixel(strip),
        _beyond_cutoff(strip),
        _cutoffs(strip),
        _enough_frequencies(results.fewest, noise_of(readout, DRAWS)),
        *(
            _accuracy(name, confusions[name], mean_share(noise, name), noise_of(readout))
            for name in STRIPS
        ),
        _confused_pixels(results.pooled, noise_of(readout, DRAWS)),
    ]


def _equal_at_low_frequency(strip: SimulatedExperiment) -> Claim:
    changes = 100 * capacitance_changes(strip.scene, LOW)
    at_lowest = 100 * capacitance_changes(strip.scene, strip.scene.frequencies[0])
    R = low_frequency_resistances(strip.scene) / 1e6
    return Claim(
        topic="At low frequency Cp does not depend on which pixel is pressed",
        source="IV-C, figure 3",
        paper="the same for all pixels",
        ours=f"dCp/Cp {listed(changes, '+.2f')} % at {LOW:g} Hz",
        agrees=near(changes, changes.mean()),
        rule="number",
        why=f"Cp(0) is the total capacitance. At the lowest interrogation frequency, "
        f"{strip.scene.frequencies[0]:.0f} Hz, it is {listed(at_lowest, '+.1f')} % already. And Rs "
        f"depends on the pixel even at zero frequency: {R[0]:.4f} Mohm unpressed, "
        f"{listed(R[1:], '.4f')} Mohm with pixel 1 to 5 pressed.",
    )


def _first_pixel(strip: SimulatedExperiment) -> Claim:
    first = [100 * capacitance_changes(strip.scene, f)[0] for f in strip.scene.frequencies]
    return Claim(
        topic="Pixel 1 raises the capacitance at all interrogation frequencies",
        source="IV-C",
        paper="larger than unpressed",
        ours=f"dCp/Cp {listed(first, '+.1f')} %",
        agrees=bool(min(first) > 0),
        rule="comparison",
        why="The field always reaches the pixel next to the interface.",
    )


def _beyond_cutoff(strip: SimulatedExperiment) -> Claim:
    f = strip.scene.frequencies[-1]
    changes = 100 * capacitance_changes(strip.scene, f)
    return Claim(
        topic="Above its cut-off a distant pixel is not seen",
        source="IV-C",
        paper="no change",
        ours=f"dCp/Cp {listed(changes, '+.1f')} % at {f / 1e3:.1f} kHz, pixel 1 to 5",
        agrees=bool(np.abs(changes[1:]).max() < 100 * strip.scene.readout.magnitude_noise),
        rule="comparison",
        why="It is seen, with the other sign: a distant capacitance is charged through the sheets' "
        "resistance, and the larger it is the more it turns current from capacitive to resistive. "
        "Pixels 4 and 5 are nearly equal, as reported.",
    )


def _cutoffs(strip: SimulatedExperiment) -> Claim:
    infinite, finite = paper_frequencies(strip.scene), open_line_frequencies(strip.scene)
    return Claim(
        topic="Half-power frequencies at the pixels' ends",
        source="III, figure 2(c)",
        paper=f"{listed(infinite, '.0f')} Hz",
        ours=f"{listed(finite, '.0f')} Hz",
        agrees=near(finite, infinite),
        rule="number",
        why="Eqs 4-6 take the wave of an infinite line. The strip ends: what its open end reflects "
        "holds the amplitude up, and all pixels but the first lose half their power at nearly one "
        "frequency.",
    )


def _enough_frequencies(fewest: xr.DataArray, noise: str) -> Claim:
    n = fewest.sizes["count"]
    right = 100 * fewest.sel(count=range(1, n)).values
    return Claim(
        topic=f"Frequencies needed for {n} pixels",
        source="III",
        paper=f"at least n - 1 = {n - 1}",
        ours=f"{listed(right, '.0f')} % of pixels right from the 1 to {n - 1} highest",
        agrees=bool(right[-2] <= ENOUGH < right[-1]),
        rule="comparison",
        noise=noise,
        why="Two numbers, Rs and Cp, come with every frequency, and no pixel is ever out of sight: "
        "few frequencies already separate most pixels, further ones average the noise and separate "
        "the strength of a press from its place.",
    )


def _accuracy(name: str, confusion: Confusion, mean: str, noise: str) -> Claim:
    right, total = REPORTED[name]
    return Claim(
        topic=f"Accuracy of the {name.removeprefix('strip-')} strip",
        source="IV-C, figure 3",
        paper=f"{100 * right / total:.1f} %",
        ours=f"{share(confusion)}; {mean}",
        agrees=same_proportion(right, total, confusion),
        rule="proportion",
        noise=noise,
        why="With 10 % spread between presses, which the paper does not state, as it does not "
        "state the noise.",
    )


def _confused_pixels(pooled: Integer, noise: str) -> Claim:
    wrong = pooled - np.diag(np.diag(pooled))
    both_ways = np.triu(wrong + wrong.T)
    first, second = np.unravel_index(both_ways.argmax(), both_ways.shape)
    return Claim(
        topic="Which pixels of the 1x5 strip are confused",
        source="IV-C",
        paper="the 4th and 5th, once in 30 sweeps",
        ours=f"most often {first + 1} and {second + 1}: {both_ways.max()} of the {wrong.sum()} "
        f"errors in {pooled.sum()} sweeps",
        agrees=bool(both_ways.max() > 0 and (first, second) == (3, 4)),
        rule="comparison",
        noise=noise,
        why="Pixels 4 and 5 have the closest curves of Cp, but Rs separates them at this noise. "
        "What goes wrong here is a press much weaker or stronger than the others, taken for its "
        "neighbour's; a meter noisier in Rs would confuse 4 and 5.",
    )
