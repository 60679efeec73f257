"""The command `rcskin calibrate`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from ..requests.argument_types import scene_of, sweeps_of, typed_paths
from ..requests.number_ranges import SESSION
from ..requests.options import CHARTS, SCENE
from ..requests.request import Request, Writing, argument, function, option, typed
from ..safe_text import say

if TYPE_CHECKING:
    import xarray as xr

    from ..requests.argument_types import Sweeps
    from ..scene.scene import Scene
    from .prior import Kind
    from .run import Calibration


class Options(Request):
    """The parameters to fit, and the part of the sweeps to fit them to."""

    fit: Sequence[str] = option(
        "A parameter to fit; may be repeated. Others keep the scene's values, and their "
        "uncertainty widens the intervals. Default: all.",
        called="names of parameters to fit. Others keep the scene's values, and their uncertainty "
        "widens the intervals. Default: all.",
        default=(),
    )
    fix: Sequence[str] = option(
        "A parameter that is known and keeps the scene's value; may be repeated. others: all that "
        "--fit does not name.",
        called='names of parameters that are known and keep the scene\'s values, or "others": all '
        "that `fit` does not name.",
        default=(),
    )
    band: str | tuple[float, float] | None = option(
        "LOW:HIGH in Hz; either may be absent.",
        called="lowest and highest frequency to use, Hz.",
        default=None,
    )
    session: int | None = option("Use sweeps of this session only.", within=SESSION, default=None)
    fixed_strength: bool = option("Use the stated strengths of presses.", default=False)
    prior: Kind = option(
        "Prior knowledge: wide (within a factor of ten), or session (as the scene's "
        "dataset.session draws).",
        among=("wide", "session"),
        called='"wide" (within a factor of ten) or "session" (as the scene\'s dataset.session '
        "draws).",
        default="wide",
    )
    uneven: bool = option(
        "Fit cosine modes of the foam's capacitance too: foam_x, foam_y, foam_xy. With --prior "
        "session, also where dataset.session draws a smooth foam_pattern.",
        called="True also fits cosine modes of the foam's capacitance: foam_x, foam_y, foam_xy.",
        default=False,
    )
    uneven_sheets: bool = option(
        "Fit cosine modes of each sheet's conductance too: top_x, top_y, top_xy, bottom_x, "
        "bottom_y, bottom_xy. Where one field describes both sheets, only their sum is identified.",
        default=False,
    )
    also: Sequence[str] = option(
        "Fit body (its distance), rim, finger or leak (of the foam) too, although the scene does "
        "not state it; or series_resistance, load_capacitance or load_conductance of readers of "
        "gains; may be repeated.",
        called='any of "body" (its distance), "rim", "finger" and "leak" (of the foam) that are '
        'fitted too, although the scene does not state them; or "series_resistance", '
        '"load_capacitance" and "load_conductance" of readers of gains.',
        default=(),
    )
    robust: bool | None = option(
        "Student's t errors of readings, so that a few far off do not move the fit, or normal "
        "ones. Default: the likelier of both.",
        "--robust/--no-robust",
        default=None,
    )

    @cached_property
    def frequencies(self) -> tuple[float, float] | None:
        """Lowest and highest frequency, Hz. Raises InputError."""
        from ..scene.frequency import parse_band

        return parse_band(self.band, (0.0, math.inf)) if isinstance(self.band, str) else self.band


class Calibrate(Options, Writing, example="calibrate sheet-5x5 run.nc -o found"):
    """Fit a scene's parameters to measured sweeps, unpressed and pressed.

    Parameters: sheet_resistance, sheet_mismatch, capacitance,
    contact_resistance (factors), loss_tangent, phase_exponent,
    lead_resistance, lead_inductance, stray_capacitance; with
    [surroundings] body and rim (factors) and finger (F).

    Sweeps may have other frequencies than the scene, and only some of its
    interfaces. The meter's errors are those of the scene's readout. Where it
    states none, they are estimated from repeated baseline sweeps, or from the
    residuals of the fit.

    FOLDER/calibrated.toml is the scene with the fitted values. All intervals
    include parameters that the data do not identify. Where one field
    describes both sheets, the data identify their sum; their ratio is assumed
    from the scene.
    """

    scene: Scene | str | Path = argument(SCENE)
    sweeps: Sweeps = argument(
        "Sweeps: FILE.nc, FILE.zarr or FILE.csv; joined.",
        "measured",
        called="measured sweeps, or the path of their file.",
    )
    output: Path = typed(
        "Folder for calibrated.toml, tables and charts.",
        "--output",
        "-o",
        default=Path("calibration"),
    )
    charts: str = typed(CHARTS, default="png")
    anyway: bool = option("Use sweeps that were recorded for another skin.", default=False)

    def run(self) -> None:
        from ..chart_style import checked_ending
        from ..progress import on_terminal
        from ..requests.requested_scene import requested_scene, warn_of_earth
        from ..sweeps import checked_folder, read_joined
        from .report import NUMBERS, WRITTEN, explanations, report_of, write_remarks
        from .run import calibrate as calibrated
        from .run import tried

        folder, ending = checked_folder(self.output, *WRITTEN), checked_ending(self.charts)
        files, name = typed_paths(self.sweeps), str(self.scene)
        loaded, sweeps = requested_scene(name), read_joined(files)
        names = ", ".join(each.name for each in files)
        self._check_skin(loaded, sweeps, names)
        with on_terminal() as progress:
            calibration = calibrated(loaded, sweeps, self, progress=progress, trials=False)
        report, told = report_of(calibration, names), explanations(calibration)
        written = report.write(folder, json=NUMBERS, charts=[ending])
        report.show()
        say(f"{folder}: {', '.join(written)}")
        with on_terminal() as progress:
            calibration = tried(calibration, progress)
        write_remarks(calibration, names, folder)
        for line in explanations(calibration):
            if line not in told:
                say(line)
        if not self.also:
            warn_of_earth(name, loaded.parts.skin)

    def result(self) -> Calibration:
        """Fit the parameters of a scene to measured sweeps, with their uncertainties.

        Raises InputError if sweeps and scene do not match, ToleranceError if no model reaches the
        tolerance.
        """
        from .run import calibrate as calibrated

        scene, sweeps = scene_of(self.scene), sweeps_of(self.sweeps)
        self._check_skin(scene, sweeps, "sweeps")
        return calibrated(scene, sweeps, self)

    def _check_skin(self, scene: Scene, sweeps: xr.Dataset, names: str) -> None:
        from ..scene.scene_files import scene_text
        from ..sweeps.same_skin import check_same_skin

        if not self.anyway:
            check_same_skin(str(sweeps.attrs.get("scene", "")), scene_text(scene), names)


calibrate = function(Calibrate)
