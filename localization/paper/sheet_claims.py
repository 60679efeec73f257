"""The paper's statements about the nxn sheet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.scene.scene_files import load_scene
from ..evaluation.confusion import Confusion
from .claim import (
    ENOUGH,
    Claim,
    listed,
    mean_share,
    near,
    neighbour_errors,
    noise_of,
    share,
)
from .paper_quantities import (
    capacitance_changes,
    paper_frequencies,
    row_contrast,
    separation_peaks,
    totals,
    unpressed_resistance,
)
from .results import Results
from .simulated_experiment import SHEETS, SimulatedExperiment
from .studies import DRAWS, LAYOUT_PIXELS, LAYOUTS, crossed_cap

if TYPE_CHECKING:
    import xarray as xr

LOW = 1.0


def claims(results: Results) -> list[Claim]:
    """Statements about cut-offs in 2-D, sensitivity, and figure 4 with its confusion matrices."""
    experiments, confusions, noise = results.experiments, results.confusions, results.noise
    readout = experiments["sheet-5x5"].scene.readout
    drawn, mean = noise_of(readout), noise_of(readout, DRAWS)
    return [
        _five_times_higher(experiments["strip-1x3"], experiments["sheet-3x3"]),
        _sensitivity(experiments["strip-1x5"], experiments["sheet-5x5"]),
        *(_accuracy(name, confusions, mean_share(noise, name), drawn) for name in SHEETS),
        _ten_frequencies(results.frequency, mean),
        _errors_of_5x5(confusions["sheet-5x5"], drawn),
        _beyond_5x5(confusions["sheet-5x5"], results.finer, drawn),
        _contacts(results.contact, mean),
        _rows(experiments["sheet-5x5"]),
    ]


def _five_times_higher(strip: SimulatedExperiment, sheet: SimulatedExperiment) -> Claim:
    RC = [totals(device.scene).R * totals(device.scene).C for device in (strip, sheet)]
    eq6 = [paper_frequencies(device.scene) for device in (strip, sheet)]
    peaks = [separation_peaks(device.scene) for device in (strip, sheet)]
    ratio = float(np.mean(peaks[1] / peaks[0]))
    return Claim(
        topic="Cut-offs of the sheet against those of the strip",
        source="IV-D",
        paper="calculated as identical, found five times higher",
        ours=f"{ratio:.1f} times higher",
        agrees=near(ratio, 5),
        rule="number",
        why="A higher cut-off needs no two-dimensional effect. The loop R C of strip and sheet as "
        f"stated differ {RC[0] / RC[1]:.1f} times, so Eq 6 with the sheet's own values gives "
        f"{listed(eq6[1] / 1e3, '.1f')} kHz for 3x3 instead of {listed(eq6[0] / 1e3, '.1f')} kHz. "
        "And f_i belongs to an infinite line: neighbouring columns differ most at "
        f"{listed(peaks[1] / 1e3, '.0f')} kHz on the sheet and at {listed(peaks[0] / 1e3, '.0f')} "
        "kHz on the strip, above f_i on both.",
    )


def _sensitivity(strip: SimulatedExperiment, sheet: SimulatedExperiment) -> Claim:
    of_strip, of_sheet = (
        100 * float(capacitance_changes(device.scene, LOW).mean()) for device in (strip, sheet)
    )
    return Claim(
        topic="Sensitivity of the 5x5 sheet against the 1x5 strip",
        source='IV-D: "n times lower"',
        paper="5 times lower",
        ours=f"{of_strip / of_sheet:.2f} times lower",
        agrees=near(of_strip / of_sheet, 5),
        rule="number",
        why=f"A doubled pixel adds 1/n of the strip's capacitance ({of_strip:.1f} %) and 1/n² of "
        f"the sheet's ({of_sheet:.1f} %).",
    )


def _accuracy(name: str, confusions: Mapping[str, Confusion], mean: str, noise: str) -> Claim:
    confusion, lower = confusions[name], name == SHEETS[-1]
    below = min(confusions[each].accuracy for each in SHEETS[:-1])
    return Claim(
        topic=f"Column accuracy of the {name.removeprefix('sheet-')} sheet",
        source="IV-D, figure 4(c)",
        paper="lower than 3x3 and 4x4" if lower else "> 90 %",
        ours=f"{share(confusion)}; {mean}",
        agrees=bool(confusion.accuracy < below if lower else 100 * confusion.accuracy > ENOUGH),
        rule="comparison",
        noise=noise,
        why="20 frequencies, Rs and Cp, 10 % spread of presses.",
    )


def _ten_frequencies(study: xr.DataArray, noise: str) -> Claim:
    mean = 100 * study.sel(scene=list(SHEETS[:2])).mean("scene")
    low, spread = (mean.sel(frequencies=f"10 {choice}") for choice in ("low", "spread"))
    low_Cp, low_both = (low.sel(quantities=names).item() for names in ("Cp", "Rs and Cp"))
    spread_Cp = spread.sel(quantities="Cp").item()
    twenty = mean.sel(frequencies="20", quantities="Rs and Cp").item()
    return Claim(
        topic="10 against 20 frequencies, mean of 3x3 and 4x4",
        source="IV-D",
        paper="about 60 % with 10; > 90 % with 20 and both Rs and Cp",
        ours=f"{low_Cp:.0f} % with the 10 lowest and Cp, {twenty:.0f} % with 20 and both",
        agrees=bool(near(low_Cp, 60) and twenty > ENOUGH),
        rule="number",
        noise=noise,
        why="If the ten lay in the band that the 1-D model gave (1 to 12 kHz here), Cp alone falls "
        f"short about as reported; Rs brings them to {low_both:.0f} %. Ten frequencies spread over "
        f"the whole band separate the columns from Cp alone ({spread_Cp:.0f} %): what helps is the "
        "higher frequencies and Rs, not the number.",
    )


def _errors_of_5x5(confusion: Confusion, noise: str) -> Claim:
    adjacent, wrong = neighbour_errors(confusion)
    recall = np.diag(confusion.counts) / np.sum(confusion.counts, axis=1)
    close, far = recall[:2].mean(), recall[2:].mean()
    return Claim(
        topic="Errors of the 5x5 sheet",
        source="IV-D",
        paper="in adjacent columns, and at pixels far from the interface",
        ours=f"{adjacent} of {wrong} in adjacent columns; {100 * close:.0f} % right in columns "
        f"1-2, {100 * far:.0f} % in 3-5",
        agrees=bool(wrong > 0 and adjacent == wrong and close >= far),
        rule="comparison",
        noise=noise,
        why="The curves of neighbouring columns draw together with distance.",
    )


def _beyond_5x5(coarse: Confusion, finer: Confusion, noise: str) -> Claim:
    return Claim(
        topic="Resolution beyond 5x5",
        source="IV-D",
        paper="degradation even more evident",
        ours=f"6x6: {share(finer)}",
        agrees=bool(finer.accuracy < coarse.accuracy),
        rule="comparison",
        noise=noise,
        why="A pixel's share of the capacitance falls as 1/n² while the meter's noise stays.",
    )


def _contacts(study: xr.DataArray, noise: str) -> Claim:
    same, crossed = (100 * study.sel(layout=layout, multiple=1.0) for layout in LAYOUTS)
    caps = [100 * crossed_cap(n) for n in LAYOUT_PIXELS]
    return Claim(
        topic="Contact layout: foil along the left and bottom edges",
        source="figure 4(a), IV-D",
        paper="columns right with > 90 % for n = 3 and 4",
        ours=f"n = 3, 4, 5: {listed(crossed.values, '.0f')} % with one sheet fed at each of the "
        f"two edges, as drawn; {listed(same.values, '.0f')} % with both fed at the left edge",
        agrees=bool((crossed.sel(n=[3, 4]) > ENOUGH).all()),
        rule="comparison",
        noise=noise,
        why="With equal sheets and crossed contacts pixels (i, j) and (j, i) read the same, which "
        f"caps columns at (n+1)/2n = {listed(caps, '.1f')} %. The paper's "
        "accuracies need both sheets contacted at one edge, as all other statements here take it.",
    )


def _rows(sheet: SimulatedExperiment) -> Claim:
    floating = load_scene("sheet-5x5-two-interfaces")
    alone, shunted = (unpressed_resistance(scene) / 1e3 for scene in (sheet.scene, floating))
    contrast = [100 * row_contrast(scene) for scene in (sheet.scene, floating)]
    noise = 100 * sheet.scene.readout.magnitude_noise
    return Claim(
        topic="Rows can be distinguished from one interface, less well than columns",
        source="V",
        paper="preliminary result",
        ours=f"rows 1 and 5 of column 3 differ by {contrast[0]:.1f} % of |Z| with foils on one "
        f"edge (the meter's noise is {noise:.1f} %), by up to {contrast[1]:.1f} % with the other "
        "edge's foils glued on and floating",
        agrees=bool(contrast[0] > noise),
        rule="comparison",
        why="Fed along one whole edge, rows i and n+1-i are mirror images and read the same. The "
        "foils of the other edge, glued on and floating, break the symmetry and lower Rs(0) from "
        f"{alone:.1f} to {shunted:.1f} kohm: a candidate for the row information.",
    )
