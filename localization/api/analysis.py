"""Limits of a skin, parameter studies, calibration of a scene to sweeps, and the gap to them."""
# pyright: standard

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.requests.argument_types import scene_of
from .arguments import checked, model_of, sweeps_of

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.bounds.touch_readings import Target
    from ...simulator.calibration.prior import Kind
    from ...simulator.calibration.run import Calibration
    from ...simulator.limits.limit import Limit
    from ...simulator.scene.randomisation import AnyDistribution
    from ...simulator.scene.scene import Scene
    from ..gap.gap_findings import GapFindings
    from ..inversion.estimators import EstimatorName
    from ..model.localizer_model import Model
    from ..study.separation import Target as PixelTarget
    from ..study.study import Study, Vary


@checked
def limits(
    scene: Scene | str | Path,
    target: Target = "column",
    presses: AnyDistribution | Mapping[str, object] | float | None = None,
    *,
    seed: int = 1,
    draws: int = 2000,
    against_rest: int = 3,
) -> Limit:
    """Compute the accuracy of the best possible classifier of a known skin.

    scene: the scene, its name or its path. target: "column", "row", "pixel", "pair" or "touches".
    presses: distribution of factors, written as the key `dataset.press.factor` of a scene; by
    default that of the scene's `press`. seed: seed of all random numbers. draws: number of sweeps
    drawn. against_rest: number of baseline sweeps whose mean each sweep is compared with; 0: none.
    Raises InputError for a meter without noise.
    """
    from ...simulator.bounds.touch_readings import best_guess, hypotheses
    from ...simulator.limits import bayes_accuracy
    from ...simulator.limits.limit import Limit
    from ...simulator.models.mechanics.force_depths import pressed_by_factors

    known = pressed_by_factors(scene_of(scene).parts, "a limit")
    factors = _factors(known.scene, presses)
    share, error = bayes_accuracy(
        known, target, factors, seed=seed, draws=draws, against_rest=against_rest
    )
    return Limit(target, share, error, best_guess(hypotheses(known.skin, known.plan, target)))


def _factors(
    scene: Scene, given: AnyDistribution | Mapping[str, object] | float | None
) -> AnyDistribution | None:
    """The distribution of factors in a scene's notation. Raises InputError if it is not one."""
    if given is None:
        return None
    drawn = scene.with_({"dataset.press.factor": given}).parts
    return drawn.plan.draws.press.factor_within(drawn.skin.foam)


@checked
def study(
    scene: Scene | str | Path,
    vary: Vary | None = None,
    *,
    target: PixelTarget = "column",
    max_frequency: float | None = None,
    draws: int = 1,
    repetitions: int | None = None,
    seed: int | None = None,
    rtol: float | None = None,
    workers: int = 1,
) -> Study:
    """Compute the accuracy of localization while one or two numbers of a scene vary.

    scene: the scene, its name or its path. vary: values by key, such as {"pixels": range(2, 11)},
    or texts as in `rcskin study --vary`; by default sheet resistances and numbers of pixels.
    target: "column", "row" or "pixel". max_frequency: the meter's upper limit, Hz. draws: number of
    independent draws of skins, presses and readings. repetitions: presses of each pixel in a draw,
    by default 2000 sweeps in all. seed: seed of all random numbers, by default the scene's. rtol:
    largest relative error of Rs and of Cp, by default well below the meter's noise. workers: number
    of processes; a script with more than one must call this under `if __name__ == "__main__":`.
    Raises InputError for an invalid key or value, ToleranceError if rtol is not reached.
    """
    from ..study.study import plan_study

    plan = plan_study(
        str(scene) if isinstance(scene, str | Path) else scene_of(scene),
        vary,
        max_frequency=max_frequency,
        target=target,
        draws=draws,
        repetitions=repetitions,
        seed=seed,
    )
    return plan.run(rtol=rtol, workers=workers)


@checked
def calibrate(
    scene: Scene | str | Path,
    sweeps: xr.Dataset | str | Path,
    *,
    fit: Sequence[str] = (),
    fix: Sequence[str] = (),
    band: tuple[float, float] | None = None,
    session: int | None = None,
    fixed_strength: bool = False,
    prior: Kind = "wide",
    uneven: bool = False,
    uneven_sheets: bool = False,
    robust: bool | None = None,
    anyway: bool = False,
) -> Calibration:
    """Fit the parameters of a scene to measured sweeps, with their uncertainties.

    scene: the scene, its name or its path. sweeps: the sweeps or the path of their file. fit: names
    of parameters to fit, by default all. fix: names of parameters that keep the scene's values, or
    "others". band: lowest and highest frequency to use, Hz. session: number of the only session to
    use. fixed_strength: True takes the strengths of presses as stated. prior: "wide" (within ten
    times) or "session" (as in the scene's dataset.session). uneven: True also fits cosine modes of
    the foam. uneven_sheets: True also fits cosine modes of each sheet. robust: True for Student's t
    errors of readings, False for normal ones, None for the likelier of both. anyway: True also
    accepts sweeps of another skin. Raises InputError if sweeps and scene do not match,
    ToleranceError if no model reaches the tolerance.
    """
    from ...simulator.calibration.fit_options import Options
    from ...simulator.calibration.prior import checked_kind
    from ...simulator.calibration.run import calibrate as calibrated
    from ...simulator.scene.scene_files import scene_text
    from ...simulator.sweeps.same_skin import check_same_skin

    scene, sweeps = scene_of(scene), sweeps_of(sweeps)
    if not anyway:
        check_same_skin(str(sweeps.attrs.get("scene", "")), scene_text(scene), "sweeps")
    options = Options(
        tuple(fit),
        tuple(fix),
        band,
        session,
        not fixed_strength,
        checked_kind(prior),
        uneven,
        uneven_sheets,
        robust=robust,
    )
    return calibrated(scene, sweeps, options)


@checked
def gap(
    simulated: xr.Dataset | str | Path,
    measured: xr.Dataset | str | Path,
    scene: Scene | str | Path | None = None,
    target: PixelTarget | None = None,
    estimator: EstimatorName | None = None,
    *,
    model: Model | str | Path | None = None,
    seed: int = 0,
    draws: int = 5,
    calibration_touches: int = 5,
    anyway: bool = False,
) -> GapFindings:
    """Compare simulated with measured sweeps, and find what explains the gap.

    simulated, measured: the sweeps or the paths of their files. scene: scene of the simulated
    sweeps, by default the one that they store. target: "column" (the default), "row" or "pixel".
    estimator: name of the localizer that is trained, by default "ksvm-ovo". model: a model to test
    instead, as it is and adapted, or the path of its file; it sets target and estimator. seed: seed
    of all random numbers. draws: number of random draws of the sweeps that are added to training.
    calibration_touches: number of pressed sweeps that calibrate; they are never tested. anyway:
    True also accepts sweeps of another skin. Raises InputError if the sweeps have no pixel,
    interface or reading in common, and for a value that does not fit them.
    """
    from ...simulator.progress import silent
    from ..gap.comparison import prepare_comparison
    from ..gap.gap_findings import find_gap
    from ..gap.options import gap_options
    from ..gap.pair import checked_pair

    own = None if model is None else model_of(model)
    if own is not None and anyway:
        own = own.for_any_skin()
    options = gap_options(target, estimator, own, seed, draws, calibration_touches)
    pair = checked_pair(
        sweeps_of(simulated, "simulated"),
        sweeps_of(measured, "measured"),
        ("`simulated`", "`measured`"),
        None if scene is None else scene_of(scene),
        own,
        seed,
        any_skin=anyway,
    )
    return find_gap(prepare_comparison(pair, options, own), silent)
