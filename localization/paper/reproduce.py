"""The whole reproduction: six experiments, the paper's figures, and its numbers and ours."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.measure.experiment import METER, stream
from ...simulator.measure.readout import read_out
from ...simulator.progress import ProgressCallback
from ...simulator.report.files import write_frame
from ...simulator.report.findings import Chart, Finding, Heading
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
from .figures import report_of
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
    report = report_of(claims, charts_of(results), software, _files(results, claims))
    report.write(folder, page="report.html", charts=(".png", ending))
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


def _files(results: Results, claims: list[Claim]) -> dict[str, Callable[[Path], object]]:
    """Functions that write tables and trained models, by the files' names."""
    import pandas as pd

    found: dict[str, Callable[[Path], object]] = {}
    for name, experiment in results.experiments.items():
        found[f"{name}-sweeps.csv"] = partial(write, experiment.measured)
        found[f"{name}-confusion.csv"] = partial(write_csv, results.confusions[name])
        model = train(experiment.measured, quantities=PAPER)
        found[f"{name}.npz"] = partial(save, model=model)
    studies = {
        "frequencies": results.frequency,
        "noise": results.noise,
        "contacts": results.contact,
    }
    frames = {name: study.to_series().reset_index() for name, study in studies.items()}
    frames["figure-2c"] = _cutoffs(results.experiments)
    frames["comparison"] = pd.DataFrame(map(dataclasses.asdict, claims))
    return found | {f"{name}.csv": partial(write_frame, table=t) for name, t in frames.items()}


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


def charts_of(results: Results) -> list[Finding]:
    """All charts, below their headings."""
    given, confusions = results.experiments, results.confusions
    scenes = {name: each.scene for name, each in given.items()}

    def drawn(name: str, draw: Callable[..., None], *shown: object) -> Chart:
        caption = CAPTIONS.get(name, f"{name}: {OF_A_DEVICE}")
        return Chart(name, caption, lambda path: draw(path, *shown))

    devices = {
        name: drawn(name, figures.experiment_figure, given[name], confusions[name])
        for name in EXPERIMENTS
    }
    return [
        Heading("Figure 2(c): the analytic model"),
        drawn("figure-2c", figures.attenuation_figure, [scenes[name] for name in STRIPS]),
        Heading("Figure 3: the strip"),
        *(devices[name] for name in STRIPS),
        Heading("Figure 4: the sheet"),
        *(devices[name] for name in SHEETS),
        Heading("What the paper varied or left open"),
        drawn("frequencies", figures.frequency_figure, results.frequency),
        drawn("noise", figures.noise_figure, results.noise, scenes),
        drawn("contacts", figures.contact_figure, results.contact),
    ]
