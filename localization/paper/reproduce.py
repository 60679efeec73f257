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
from ...simulator.scene.scene_files import load_scene
from ...simulator.sweeps import checked_folder, made_folder, write
from ..evaluation.confusion import Confusion, write_csv
from ..evaluation.evaluation import cross_validate, unchecked
from ..inputs.feature_names import PAPER
from ..model.localizer_file import save
from ..model.training import train
from . import figures
from .claim import Claim
from .claims import Results, all_claims
from .paper_quantities import open_line_frequencies, paper_frequencies
from .report import write_report
from .simulated_experiment import (
    EXPERIMENTS,
    SHEETS,
    STRIPS,
    SimulatedExperiment,
    simulate_experiment,
    with_pixels,
)
from .studies import (
    contact_study,
    exact_sweeps,
    fewest_frequencies,
    frequency_study,
    noise_study,
    pooled_counts,
)

if TYPE_CHECKING:
    import pandas as pd

FINER_PIXELS = 6
WRITTEN = ("report.html", "comparison.csv", "figure-2c.*", "frequencies.*", "noise.*", "contacts.*")
WRITTEN += tuple(f"{name}[-.]*" for name in EXPERIMENTS)
"""Name patterns of the files of a reproduction."""


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
    measured = read_out(exact_sweeps(scene, progress), scene.readout, stream(scene, METER))
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

    tables = []
    for name in EXPERIMENTS:
        scene = experiments[name].scene
        n = scene.pixels.columns
        tables.append(
            pd.DataFrame(
                {
                    "scene": name,
                    "pixel": np.arange(1, n + 1),
                    "x_m": scene.skin.length * np.arange(1, n + 1) / n,
                    "infinite_line_Hz": paper_frequencies(scene),
                    "open_line_Hz": open_line_frequencies(scene),
                }
            )
        )
    return pd.concat(tables)


def draw(
    folder: Path, results: Results, progress: ProgressCallback, ending: str
) -> list[ReportSection]:
    """Write all charts as .png, and in another format if given; return those of the report."""

    def drawn(name: str, draw: Callable[[Path], None]) -> Path:
        for path in {folder / f"{name}{each}" for each in (".png", ending)}:
            draw(path)
        return folder / f"{name}.png"

    scenes = {name: experiment.scene for name, experiment in results.experiments.items()}

    def device(path: Path) -> None:
        name = path.stem
        figures.experiment_figure(path, results.experiments[name], results.confusions[name])

    strips = [scenes[name] for name in STRIPS]
    attenuation = drawn("figure-2c", lambda path: figures.attenuation_figure(path, strips))
    devices = {
        name: drawn(name, device) for name in tracked(list(EXPERIMENTS), "figures", progress)
    }
    frequencies = drawn(
        "frequencies", lambda path: figures.frequency_figure(path, results.frequency)
    )
    noise = drawn("noise", lambda path: figures.noise_figure(path, results.noise, scenes))
    contacts = drawn("contacts", lambda path: figures.contact_figure(path, results.contact))
    return [
        ReportSection(
            "Figure 2(c): the analytic model",
            [Picture(attenuation, "Amplitude at the end of each pixel; dots are Eq 6.")],
        ),
        ReportSection("Figure 3: the strip", [_device(name, devices[name]) for name in STRIPS]),
        ReportSection("Figure 4: the sheet", [_device(name, devices[name]) for name in SHEETS]),
        ReportSection(
            "What the paper varied or left open",
            [
                Picture(frequencies, "10 against 20 frequencies, with and without Rs."),
                Picture(noise, "Accuracy against the meter's noise, mean of all draws."),
                Picture(contacts, "Both sheets fed at one edge against crossed edges."),
            ],
        ),
    ]


def _device(name: str, path: Path) -> Picture:
    return Picture(path, f"{name}: curves are noise-free, dots are what the meter showed.")
