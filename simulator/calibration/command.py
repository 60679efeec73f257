"""The command `rcskin calibrate`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from ..requests.options import Charts, SceneName
from ..safe_text import say, terminal


def calibrate(
    scene: SceneName,
    measured: Annotated[
        list[Path], typer.Argument(help="Sweeps: FILE.nc, FILE.zarr or FILE.csv; joined.")
    ],
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for calibrated.toml, tables and charts.")
    ] = Path("calibration"),
    fit: Annotated[
        list[str] | None,
        typer.Option(
            help="A parameter to fit; may be repeated. Others keep the scene's values, and their "
            "uncertainty widens the intervals. Default: all."
        ),
    ] = None,
    fix: Annotated[
        list[str] | None,
        typer.Option(
            help="A parameter that is known and keeps the scene's value; may be repeated. others: "
            "all that --fit does not name."
        ),
    ] = None,
    band: Annotated[str | None, typer.Option(help="LOW:HIGH in Hz; either may be absent.")] = None,
    session: Annotated[int | None, typer.Option(help="Use sweeps of this session only.")] = None,
    fixed_strength: Annotated[
        bool, typer.Option("--fixed-strength", help="Use the stated strengths of presses.")
    ] = False,
    prior: Annotated[
        str,
        typer.Option(
            help="Prior knowledge: wide (within a factor of ten), or session (as the scene's "
            "dataset.session draws)."
        ),
    ] = "wide",
    uneven: Annotated[
        bool,
        typer.Option(
            "--uneven",
            help="Fit cosine modes of the foam's capacitance too: foam_x, foam_y, foam_xy. With "
            "--prior session, also where dataset.session draws a smooth foam_pattern.",
        ),
    ] = False,
    uneven_sheets: Annotated[
        bool,
        typer.Option(
            "--uneven-sheets",
            help="Fit cosine modes of each sheet's conductance too: top_x, top_y, top_xy, "
            "bottom_x, bottom_y, bottom_xy. Where one field describes both sheets, only their sum "
            "is identified.",
        ),
    ] = False,
    also: Annotated[
        list[str] | None,
        typer.Option(
            help="Fit body (its distance), rim, finger or leak (of the foam) too, although the "
            "scene does not state it; or series_resistance, load_capacitance or load_conductance "
            "of readers of gains; may be repeated."
        ),
    ] = None,
    robust: Annotated[
        bool | None,
        typer.Option(
            "--robust/--no-robust",
            help="Student's t errors of readings, so that a few far off do not move the fit, or "
            "normal ones. Default: the likelier of both.",
        ),
    ] = None,
    charts: Charts = "png",
    force: Annotated[
        bool, typer.Option("--anyway", help="Use sweeps that were recorded for another skin.")
    ] = False,
) -> None:
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

    from ..chart_style import checked_ending
    from ..progress import on_terminal
    from ..requests.requested_scene import requested_scene, warn_of_earth
    from ..scene.frequency import parse_band
    from ..scene.scene_files import scene_text
    from ..sweeps import checked_folder, read_joined
    from ..sweeps.same_skin import check_same_skin
    from .fit_options import Options
    from .prior import checked_kind
    from .results.explanations import explanations
    from .results.report import WRITTEN, correlations, table, write_remarks, write_report
    from .run import calibrate as calibrated
    from .run import tried

    folder, ending = checked_folder(output, *WRITTEN), checked_ending(charts)
    options = Options(
        tuple(fit or ()),
        tuple(fix or ()),
        None if band is None else parse_band(band, (0.0, math.inf)),
        session,
        not fixed_strength,
        checked_kind(prior),
        uneven,
        uneven_sheets,
        tuple(also or ()),
        robust,
        trials=False,
    )
    loaded, sweeps = requested_scene(scene), read_joined(measured)
    names = ", ".join(each.name for each in measured)
    if not force:
        check_same_skin(str(sweeps.attrs.get("scene", "")), scene_text(loaded), names)
    with on_terminal() as progress:
        calibration = calibrated(loaded, sweeps, options, progress=progress)
    written = write_report(calibration, names, folder, ending)
    console = terminal()
    console.print(table(calibration))
    if len(calibration.intervals) > 1:
        console.print(correlations(calibration, console))
    told = explanations(calibration)
    say(*told, f"{folder}: {', '.join(written)}")
    with on_terminal() as progress:
        calibration = tried(calibration, progress)
    write_remarks(calibration, names, folder)
    for line in explanations(calibration):
        if line not in told:
            say(line)
    if not also:
        warn_of_earth(scene, loaded.parts.skin)
