"""The command `rcskin limits`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..requests.argument_types import scene_of
from ..requests.number_ranges import DRAWS, FREQUENCIES, AllowedRange
from ..requests.options import (
    AGAINST_REST,
    BASELINE_SWEEPS,
    CHARTS,
    INTERFACES,
    SCENE,
    SEED_OF_ALL,
    TOUCH_FACTOR,
    TOUCH_SIDE,
)
from ..requests.request import Writing, argument, called, function, option, typed
from ..safe_text import say

if TYPE_CHECKING:
    from ..bounds.touch_readings import Target
    from ..progress import ProgressCallback
    from ..scene.parts import SceneParts
    from ..scene.randomisation import AnyDistribution
    from ..scene.scene import Scene
    from .limit import Limit
    from .touch_identity import Sampling

FOLDER = Path("limits")


class Limits(Writing, example="limits sheet-5x5 -o limits"):
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

    scene: Scene | str | Path = argument(SCENE)
    output: Path | None = typed(
        "Folder for maps, tables and summary; else ./limits.", "--output", "-o", default=None
    )
    interface: Sequence[str] | None = typed(INTERFACES, default=None)
    sheet_resistance: str | None = typed(
        "R,R,... in ohm/sq of both sheets, for further maps.", default=None
    )
    n: int | None = typed(
        "Frequencies in each set; default: one for each pixel from the driven edge.",
        "-n",
        within=FREQUENCIES,
        default=None,
    )
    size: float | None = typed(TOUCH_SIDE, default=None)
    factor: float | None = typed(TOUCH_FACTOR, default=None)
    finger: str | None = typed(
        "Kind of touch: finger (earthed), floating, rod, or 5.3pF.", default=None
    )
    target: Target = called('"column", "row", "pixel", "pair" or "touches".', default="column")
    presses: AnyDistribution | Mapping[str, object] | float | None = called(
        "distribution of factors, written as the key `dataset.press.factor` of a scene; by default "
        "that of the scene's `press`.",
        default=None,
    )
    against_rest: int = option(AGAINST_REST, default=BASELINE_SWEEPS)
    unknown_skin: bool = typed("Skins differ by `dataset.session` of the scene.", default=False)
    charts: str = typed(CHARTS, default="png")
    accuracy: float | None = typed(
        "Print the largest number of pixels at which a classifier can be this accurate, "
        "0 to 1, for grids in the proportion of the scene's.",
        within=AllowedRange(0.01, 0.999999, "a fraction of sweeps between none and all"),
        default=None,
    )
    draws: int = option("Number of sweeps drawn for an accuracy.", within=DRAWS, default=2000)
    seed: int = option(SEED_OF_ALL, default=1)

    def run(self) -> None:
        from ..progress import Overall, on_terminal
        from ..requests.requested_scene import requested_scene
        from ..requests.time_estimates import limit_parts

        requested = requested_scene(str(self.scene))
        with on_terminal() as bars:
            progress = Overall(
                "limits in all", limit_parts(requested.parts.skin, requested.parts.setup), bars
            )
            from ..bounds.position_bound import chosen_touch
            from ..chart_style import checked_ending
            from ..models.mechanics.force_depths import pressed_by_factors
            from ..scene.supports import supported
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

            by_factors = pressed_by_factors(
                supported("a limit", with_finger(requested, self.finger).parts)
            )
            side = None if self.size is None else 1e-3 * self.size
            touch = chosen_touch(by_factors.skin, by_factors.plan.press, side, self.factor)
            loaded = with_factor(with_interfaces(by_factors, self.interface or []), 1 + touch.rise)
            options = SurveyOptions(
                touch, self.against_rest, self.unknown_skin, not loaded.plan.press.by_factor
            )
            sampling = Sampling(self.seed, self.draws, self.against_rest, side)
            ending = checked_ending(self.charts)
            resistances = _listed(self.sheet_resistance)
            for resistance in resistances:
                with_sheets(loaded, resistance)
            if self.accuracy is not None:
                _print_counts(loaded, self.accuracy, sampling, progress)
            if self.accuracy is None or self.output is not None:
                folder = checked_folder(made_folder(self.output or FOLDER), *WRITTEN)
                variants = survey(loaded, options, resistances, self.n, progress)
                pixel_limits = identity(loaded, sampling, progress)
                rasterization = survey_rasterization_errors(loaded, options)
                found = SurveyResults(loaded, options, variants, pixel_limits, rasterization)
                report = found.report
                report.write(folder, json="limits.json", charts=[ending])
                report.show(folder / "limits.json")
                say(f"maps and tables written to {folder}")

    def result(self) -> Limit:
        """Compute the accuracy of the best possible classifier of a known skin.

        Raises InputError for a meter without noise.
        """
        from ..bounds.touch_readings import best_guess, hypotheses
        from ..models.mechanics.force_depths import pressed_by_factors
        from ..scene.supports import supported
        from . import bayes_accuracy
        from .limit import Limit

        known = pressed_by_factors(supported("a limit", scene_of(self.scene).parts))
        share, error = bayes_accuracy(
            known,
            self.target,
            self._factors(known.scene),
            seed=self.seed,
            draws=self.draws,
            against_rest=self.against_rest,
        )
        best = best_guess(hypotheses(known.skin, known.plan, self.target))
        return Limit(self.target, share, error, best)

    def _factors(self, scene: Scene) -> AnyDistribution | None:
        """The distribution of factors in the scene's notation. Raises InputError for others."""
        if self.presses is None:
            return None
        drawn = scene.with_({"dataset.press.factor": self.presses}).parts
        return drawn.plan.draws.press.factor_within(drawn.skin.foam)


limits = function(Limits)


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
