"""The whole reproduction: six experiments, the paper's figures, and its numbers and ours."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.measure.experiment import METER, stream
from ...simulator.measure.readout import read_out
from ...simulator.progress import ProgressCallback, tracked
from ...simulator.report.files import filled_at_once, write_frame
from ...simulator.report.page import Picture, ReportSection
from ...simulator.scene.scene import Scene
from ...simulator.scene.scene_files import load_scene
from ...simulator.sweeps import checked_folder, made_folder, write
from ..evaluation.confusion import Confusion, write_csv
from ..evaluation.evaluation import cross_validate, unchecked
from ..inputs.features import PAPER
from ..model.localizer_file import save
from ..model.training import train
from . import figures
from .claims import Claim, all_claims
from .figures import write_report
from .paper_quantities import open_line_frequencies, paper_frequencies
from .studies import (
    EXPERIMENTS,
    SHEETS,
    STRIPS,
    Results,
    SimulatedExperiment,
    contact_study,
    exact_sweeps,
    fewest_frequencies,
    frequency_study,
    noise_study,
    pooled_counts,
    simulate_experiment,
    with_pixels,
)

if TYPE_CHECKING:
    import pandas as pd

FINER_PIXELS = 6
WRITTEN = ("report.html", "comparison.csv", "figure-2c.*", "frequencies.*", "noise.*", "contacts.*")
WRITTEN += tuple(f"{name}[-.]*" for name in EXPERIMENTS)
"""Name patterns of the files of a reproduction."""
CAPTIONS = {
    "figure-2c": "Amplitude at the end of each pixel; dots are Eq 6.",
    "frequencies": "10 against 20 frequencies, with and without Rs.",
    "noise": "Accuracy against the meter's noise, mean of all draws.",
    "contacts": "Both sheets fed at one edge against crossed edges.",
}
OF_A_DEVICE = "curves are noise-free, dots are what the meter showed."


@unchecked()
def reproduce(folder: Path, progress: ProgressCallback, ending: str = ".png") -> list[Claim]:
    """Write figures, tables, trained models and `report.html` into `folder`; return the claims.

    The folder is created if it does not exist; all files appear in it at the end. ending: format of
    further figures, besides .png. Tables have the same bytes in every run. Raises InputError if the
    folder cannot be created, or if one of the files exists and may not be replaced.
    """
    checked_folder(made_folder(folder), *WRITTEN)
    results = _experiments(progress)
    claims = all_claims(results)
    software = results.experiments["sheet-5x5"].exact.attrs["software"]
    with filled_at_once(folder) as made:
        _write_tables(made, results, claims)
        pictures = draw(made, results, progress, ending)
        write_report(made / "report.html", claims, pictures, software)
    return claims


def _experiments(progress: ProgressCallback) -> Results:
    experiments = {name: simulate_experiment(load_scene(name), progress) for name in EXPERIMENTS}
    confusions = {
        name: cross_validate(
            experiment.measured, quantities=PAPER, seed=experiment.scene.experiment.seed
        )
        for name, experiment in experiments.items()
    }
    sheets = [experiments[name] for name in SHEETS]
    return Results(
        experiments=experiments,
        confusions=confusions,
        frequency=frequency_study(sheets, progress),
        noise=noise_study(list(experiments.values()), progress),
        contact=contact_study(progress),
        finer=_beyond(progress),
        fewest=fewest_frequencies(experiments["strip-1x5"]),
        pooled=pooled_counts(experiments["strip-1x5"]),
    )


def _beyond(progress: ProgressCallback) -> Confusion:
    scene = with_pixels(load_scene("sheet-5x5"), FINER_PIXELS)
    measured = read_out(
        exact_sweeps(scene.parts, progress), scene.readout, stream(scene.parts.plan, METER)
    )
    return cross_validate(measured, quantities=PAPER, seed=scene.experiment.seed)


def _write_tables(folder: Path, results: Results, claims: list[Claim]) -> None:
    import pandas as pd

    for name, experiment in results.experiments.items():
        write(experiment.measured, folder / f"{name}-sweeps.csv")
        write_csv(results.confusions[name], folder / f"{name}-confusion.csv")
        save(folder / f"{name}.npz", train(experiment.measured, quantities=PAPER))
    for name, study in (
        ("frequencies", results.frequency),
        ("noise", results.noise),
        ("contacts", results.contact),
    ):
        write_frame(folder / f"{name}.csv", study.to_series().reset_index())
    write_frame(folder / "figure-2c.csv", _cutoffs(results.experiments))
    write_frame(folder / "comparison.csv", pd.DataFrame(map(dataclasses.asdict, claims)))


def _cutoffs(experiments: Mapping[str, SimulatedExperiment]) -> pd.DataFrame:
    """Half-power frequencies of each pixel's end on the infinite and the finite open line."""
    import pandas as pd

    def table(name: str, scene: Scene) -> pd.DataFrame:
        pixel = np.arange(1, scene.pixels.columns + 1)
        columns = {
            "scene": name,
            "pixel": pixel,
            "x_m": scene.skin.length * pixel / pixel.size,
            "infinite_line_Hz": paper_frequencies(scene.parts.skin),
            "open_line_Hz": open_line_frequencies(scene.parts.skin),
        }
        return pd.DataFrame(columns)

    return pd.concat(table(name, experiments[name].scene) for name in EXPERIMENTS)


def draw(
    folder: Path, results: Results, progress: ProgressCallback, ending: str
) -> list[ReportSection]:
    """Write all charts as .png, and in another format if given; return those of the report."""

    def drawn(name: str, draw: Callable[..., None], *shown: object) -> Picture:
        for path in {folder / f"{name}{each}" for each in (".png", ending)}:
            draw(path, *shown)
        return Picture(folder / f"{name}.png", CAPTIONS.get(name, f"{name}: {OF_A_DEVICE}"))

    given, confusions = results.experiments, results.confusions
    scenes = {name: each.scene for name, each in given.items()}
    attenuation = drawn("figure-2c", figures.attenuation_figure, [scenes[name] for name in STRIPS])
    devices = {
        name: drawn(name, figures.experiment_figure, given[name], confusions[name])
        for name in tracked(list(EXPERIMENTS), "figures", progress)
    }
    varied = [
        drawn("frequencies", figures.frequency_figure, results.frequency),
        drawn("noise", figures.noise_figure, results.noise, scenes),
        drawn("contacts", figures.contact_figure, results.contact),
    ]
    return [
        ReportSection("Figure 2(c): the analytic model", [attenuation]),
        ReportSection("Figure 3: the strip", [devices[name] for name in STRIPS]),
        ReportSection("Figure 4: the sheet", [devices[name] for name in SHEETS]),
        ReportSection("What the paper varied or left open", varied),
    ]
