"""The command `rcskin gap`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.requests.argument_types import scene_of, sweeps_of, typed_paths
from ...simulator.requests.number_ranges import TRAININGS, AllowedRange
from ...simulator.requests.options import SEED_OF_ALL, complete_scene
from ...simulator.requests.request import Writing, argument, function, option, typed
from ...simulator.safe_text import say
from .model_notes import load_model_for, model_of
from .options import ANYWAY, complete_estimator

if TYPE_CHECKING:
    from ...simulator.requests.argument_types import Sweeps
    from ...simulator.scene.scene import Scene
    from ..gap.gap_findings import GapFindings
    from ..gap.options import GapOptions, PixelTarget
    from ..inversion.estimators import EstimatorName
    from ..model.localizer_model import Model


class Gap(Writing, example="gap all.nc run.nc -o gap"):
    """Compare simulated with measured sweeps, and find what explains the gap.

    The report has distances of Rs and Cp, accuracies of a localizer trained on
    simulation and on a few touches, before and after calibration, distances of
    the features' distributions, and the parameter that explains most. With
    --model, your own model is tested instead, unchanged and adapted by a few
    touches, and its probabilities are compared with the truth.
    """

    simulated: Sweeps = argument("Simulated sweeps, .nc, .zarr or .csv.", kind=Path)
    measured: Sweeps = argument("Sweeps of the skin itself, or of a twin; joined.")
    output: Path = typed("Folder for gap.html and gap.json.", "--output", "-o")
    scene: Scene | str | Path | None = option(
        "Scene of the simulated sweeps; default: the scene that they store.",
        complete=complete_scene,
        default=None,
        kw_only=False,
    )
    target: PixelTarget | None = option(
        "column (the default), row or pixel.",
        among=("column", "row", "pixel"),
        called='"column" (the default), "row" or "pixel".',
        default=None,
        kw_only=False,
    )
    estimator: EstimatorName | None = option(
        "Name of the localizer; default: ksvm-ovo.",
        complete=complete_estimator,
        default=None,
        kw_only=False,
    )
    model: Model | str | Path | None = option(
        "Test this model, MODEL.npz, instead of training one.",
        kind=Path,
        called="a model to test instead of training one, as it is and adapted, or the path of its "
        "file; it sets target and estimator.",
        default=None,
    )
    seed: int = option(SEED_OF_ALL, default=0)
    draws: int = option("Number of random draws of the added sweeps.", within=TRAININGS, default=5)
    calibration_touches: int = option(
        "Number of pressed sweeps that calibrate; they are never tested.",
        within=AllowedRange(0, 10**6, "pressed sweeps"),
        default=5,
    )
    anyway: bool = option(ANYWAY, default=False)
    charts: str | None = typed("Also write the charts as files: png, svg or pdf.", default=None)

    def run(self) -> None:
        from ...simulator.chart_style import checked_ending
        from ...simulator.progress import on_terminal
        from ...simulator.requests.requested_scene import requested_scene, warn_of_earth
        from ...simulator.sweeps import checked_folder, made_folder, read, read_joined
        from ..gap.comparison import prepare_comparison
        from ..gap.gap_findings import HTML, JSON, find_gap
        from ..gap.pair import checked_pair

        ending = None if self.charts is None else checked_ending(self.charts)
        (ours,), theirs = typed_paths(self.simulated), typed_paths(self.measured)
        sides, model = (read(ours), read_joined(theirs)), None
        if self.model is not None:
            (own,) = typed_paths(self.model)
            model = load_model_for(sides[1], theirs, own, any_skin=self.anyway)
        settings = self._options(model)
        scene = requested_scene(str(self.scene)) if self.scene else None
        names = str(ours), ", ".join(map(str, theirs))
        pair = checked_pair(*sides, names, scene, model, self.seed, any_skin=self.anyway)
        checked_folder(made_folder(self.output), JSON, HTML)
        with on_terminal() as progress:
            findings = find_gap(prepare_comparison(pair, settings, model), progress)
        report = findings.report
        report.write(self.output, json=JSON, page=HTML, charts=[ending] if ending else ())
        report.show()
        say(_written(findings, self.output / HTML))
        if pair.scene is not None:
            warn_of_earth(pair.scene.name, pair.scene.parts.skin)

    def result(self) -> GapFindings:
        """Compare simulated with measured sweeps, and find what explains the gap.

        Raises InputError if the sweeps have no pixel, interface or reading in common, and for a
        value that does not fit them.
        """
        from ...simulator.progress import silent
        from ..gap.comparison import prepare_comparison
        from ..gap.gap_findings import find_gap
        from ..gap.pair import checked_pair

        model = None if self.model is None else model_of(self.model)
        if model is not None and self.anyway:
            model = model.for_any_skin()
        settings = self._options(model)
        pair = checked_pair(
            sweeps_of(self.simulated, "simulated"),
            sweeps_of(self.measured, "measured"),
            ("`simulated`", "`measured`"),
            None if self.scene is None else scene_of(self.scene),
            model,
            self.seed,
            any_skin=self.anyway,
        )
        return find_gap(prepare_comparison(pair, settings, model), silent)

    def _options(self, model: Model | None) -> GapOptions:
        """Options with defaults, or with the target and the estimator of a model that is tested.

        Raises InputError if a target or an estimator is given beside a model.
        """
        from ...simulator.sweeps.errors import InputError, named
        from ..gap.options import GapOptions

        target, estimator = self.target or "column", self.estimator or "ksvm-ovo"
        if model is not None:
            if self.target or self.estimator:
                own, *others = map(named, ("model", "target", "estimator"))
                raise InputError(
                    f"{own} already sets target and estimator: leave out {' and '.join(others)}"
                )
            target, estimator = model.target, model.estimator
        return GapOptions(target, estimator, self.seed, self.draws, self.calibration_touches)


gap = function(Gap)


def _written(findings: GapFindings, report: Path) -> str:
    pair = findings.trial.pair
    ours, theirs = pair.simulated.sizes["sweep"], pair.other.sizes["sweep"]
    return f"gap: {ours} simulated and {theirs} {pair.label.adjective} sweeps -> {report}"
