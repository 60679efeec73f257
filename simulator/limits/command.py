"""The command `rcskin limits`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..requests.options import (
    BASELINE_SWEEPS,
    AgainstRest,
    Charts,
    Interfaces,
    SceneName,
    TouchFactor,
    TouchSide,
)
from ..safe_text import say

if TYPE_CHECKING:
    from ..progress import ProgressCallback
    from ..scene.parts import SceneParts
    from .touch_identity import Sampling

FOLDER = Path("limits")


def limits(
    scene: SceneName,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for maps, tables and summary; else ./limits."),
    ] = None,
    interface: Interfaces = None,
    sheet_resistance: Annotated[
        str | None, typer.Option(help="R,R,... in ohm/sq of both sheets, for further maps.")
    ] = None,
    n: Annotated[
        int | None,
        typer.Option(
            "-n", help="Frequencies in each set; default: one for each pixel from the driven edge."
        ),
    ] = None,
    size: TouchSide = None,
    factor: TouchFactor = None,
    finger: Annotated[
        str | None,
        typer.Option(help="Kind of touch: finger (earthed), floating, rod, or 5.3pF."),
    ] = None,
    against_rest: AgainstRest = BASELINE_SWEEPS,
    unknown_skin: Annotated[
        bool,
        typer.Option("--unknown-skin", help="Skins differ by `dataset.session` of the scene."),
    ] = False,
    charts: Charts = "png",
    accuracy: Annotated[
        float | None,
        typer.Option(
            help="Print the largest number of pixels at which a classifier can be this accurate, "
            "0 to 1, for grids in the proportion of the scene's."
        ),
    ] = None,
    draws: Annotated[int, typer.Option(help="Number of sweeps drawn for an accuracy.")] = 2000,
    seed: Annotated[int, typer.Option(help="Seed of all random numbers.")] = 1,
) -> None:
    """Compute the limits of one sweep for any estimator of a touch.

    The results are maps of the Cramer-Rao bound on x, y and strength over the
    sheet, by frequency set, interface and sheet resistance; distances between
    the sweeps of pixels, in units of the meter's error; and the Bayes accuracy
    of columns, rows and pixels, which no classifier exceeds. Each result states
    what it assumes as known. --size, --factor and --finger apply to all of
    them. If a finger presses the scene, there are also accuracies for a rod,
    and for a finger that touches without a press; --factor 1 is that touch
    alone.

    --accuracy prints the largest number of pixels at which it is possible, for
    grids in the proportion of the scene's rows and columns.
    """
    from ..progress import Overall, on_terminal
    from ..requests.requested_scene import requested_scene
    from ..requests.time_estimates import limit_parts

    requested = requested_scene(scene)
    with on_terminal() as bars:
        progress = Overall(
            "limits in all", limit_parts(requested.parts.skin, requested.parts.setup), bars
        )
        from ..bounds.position_bound import chosen_touch
        from ..chart_style import checked_ending
        from ..models.mechanics.force_depths import pressed_by_factors
        from ..sweeps import checked_folder, made_folder
        from .survey import (
            SurveyOptions,
            survey,
            survey_rasterization_errors,
            with_factor,
            with_finger,
            with_interfaces,
            with_sheets,
        )
        from .survey_results import WRITTEN, SurveyResults
        from .touch_identity import Sampling, identity

        by_factors = pressed_by_factors(with_finger(requested, finger).parts, "a limit")
        side = None if size is None else 1e-3 * size
        touch = chosen_touch(by_factors.skin, by_factors.plan.press, side, factor)
        loaded = with_factor(with_interfaces(by_factors, interface or []), 1 + touch.rise)
        options = SurveyOptions(touch, against_rest, unknown_skin, not loaded.plan.press.by_factor)
        sampling = Sampling(seed, draws, against_rest, side)
        ending = checked_ending(charts)
        resistances = _listed(sheet_resistance)
        for resistance in resistances:
            with_sheets(loaded, resistance)
        if accuracy is not None:
            _print_counts(loaded, accuracy, sampling, progress)
        if accuracy is None or output is not None:
            folder = checked_folder(made_folder(output or FOLDER), *WRITTEN)
            variants = survey(loaded, options, resistances, n, progress)
            pixel_limits = identity(loaded, sampling, progress)
            rasterization = survey_rasterization_errors(loaded, options)
            found = SurveyResults(loaded, options, variants, pixel_limits, rasterization)
            found.write(folder, ending)
            found.show(folder)


def _listed(text: str | None) -> list[float]:
    from ..sweeps import InputError
    from ..sweeps.units import quantity

    try:
        return [quantity(part, "ohm/sq") for part in text.split(",")] if text is not None else []
    except ValueError:
        raise InputError(f"--sheet-resistance must be R,R,... in ohm/sq, got {text}") from None


def _print_counts(
    parts: SceneParts, accuracy: float, sampling: Sampling, progress: ProgressCallback
) -> None:
    from .touch_identity import MAX_PIXELS, MIN_PIXELS, counts, grid_text

    for target in ("column", "pixel"):
        found = list(counts(parts, target, accuracy, sampling, progress))
        reached = [each for each in found if each.reaches(accuracy)]
        best = reached[-1] if reached else None
        if best is None:
            possible = f"not possible even with {grid_text(parts, MIN_PIXELS)} pixels"
        elif best.n == MAX_PIXELS:
            possible = f"possible with {grid_text(parts, best.n)} pixels or more"
        else:
            possible = f"possible with at most {grid_text(parts, best.n)} pixels"
        rows, columns = parts.skin.pixels.shape
        evaluated = "; ".join(
            f"{grid_text(parts, each.n)} at most {100 * each.accuracy.share:.1f} "
            f"± {100 * each.accuracy.error:.1f} %"
            for each in found
        )
        say(
            f"{target}: an accuracy of {100 * accuracy:g} % is {possible} (rows x columns, in the "
            f"proportion {rows}:{columns} of the scene; evaluated: {evaluated})"
        )
