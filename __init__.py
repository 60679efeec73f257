"""Simulator of a capacitive soft sensor skin, its localizer, and the driver of its meter.

    import rcskin

    scene = rcskin.load("sheet-5x5").with_({"skin.top.sheet_resistance": 35e3})
    sweeps = rcskin.sweep(scene, ["2,3", "none"], rtol=1e-6)
    rcskin.plot(sweeps, "sweeps.png")

    recorded = rcskin.measured(sweeps, seed=1)  # with the meter's noise
    skins = rcskin.dataset(scene, 2000)
    model = rcskin.train(skins)  # or rcskin.load_model("columns.skops")
    rcskin.evaluate(model, recorded)["accuracy"]
    rcskin.localize(model, recorded).labels

Nothing is imported before it is used.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    __version__: str
    import xarray as xr
    from numpy.typing import NDArray

    from .localization.learners.registry import Registry
    from .localization.model.model import Model
    from .localization.trust.answers import Answers
    from .simulator.calibration.run import Calibration
    from .simulator.models.reduced.model import Reduced
    from .simulator.press.press import Press
    from .simulator.scene.scene import Scene

__all__ = [
    "__version__",
    "calibrate",
    "dataset",
    "evaluate",
    "features",
    "limits",
    "load",
    "load_model",
    "localize",
    "measured",
    "plot",
    "read",
    "reduce",
    "sweep",
    "train",
    "write",
]


def __dir__() -> list[str]:
    return __all__


def __getattr__(name: str) -> str:
    """The version, which is looked up where it is asked for."""
    if name == "__version__":
        from importlib.metadata import version

        return version("rcskin")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def load(scene: str | Path) -> Scene:
    """The built-in scene of that name, or the one in the TOML file at that path.

    Raises InputError in one line naming the file, the key, the value and what is allowed.
    """
    from .simulator.scene.files import load_scene

    return load_scene(scene)


def _scene(given: Scene | str | Path) -> Scene:
    return load(given) if isinstance(given, str | Path) else given


def sweep(
    scene: Scene | str | Path,
    presses: Sequence[str | Press] | None = None,
    *,
    rtol: float = 1e-4,
    model: str = "auto",
) -> xr.Dataset:
    """Noise-free sweeps of presses, with the estimated errors of Rs and Cp.

    scene: or its name or path, as for `load`. presses: as texts ("2,3", "1,1:1.5+4,4", "none") or
    parsed; by default nothing pressed, then every pixel. rtol: the largest relative error of Rs and
    of Cp. model: auto, lumped, line, sheet or reduced. Raises InputError for a press that does not
    fit the scene, ToleranceError where rtol cannot be kept.
    """
    from .simulator.measure.simulate import check_fits, simulate
    from .simulator.models.solver import Solver, checked_model
    from .simulator.press.press import every_press, press_on

    _check("sweep", {"rtol": rtol})
    scene = _scene(scene)
    asked = every_press(scene) if presses is None else presses
    parsed = [press_on(scene, each) if isinstance(each, str) else each for each in asked]
    check_fits(scene, len(parsed))
    return simulate(Solver(scene, rtol, checked_model(model)), parsed)


def _check(command: str, options: dict[str, Any]) -> None:
    """Raises InputError for numbers that the command line would not take either."""
    from .simulator.asked.numbers import check_numbers

    check_numbers(command, options)


def measured(sweeps: xr.Dataset, seed: int = 1) -> xr.Dataset:
    """Simulated sweeps as the meter of their scene shows them, with its noise, session by session.

    seed: of the noise. Raises InputError where the sweeps store no scene.
    """
    from .simulator.measure.simulate import read_by_meter
    from .simulator.sweeps import InputError

    text = str(sweeps.attrs.get("scene", ""))
    if not text:
        raise InputError("the sweeps store no scene, whose `readout` says how the meter errs")
    return read_by_meter(sweeps, text, seed)


def dataset(
    scene: Scene | str | Path, sweeps: int = 2000, *, seed: int = 1, rtol: float = 1e-4
) -> xr.Dataset:
    """Simulated sweeps of random skins and presses, with the meter's noise, to train or test on.

    scene: or its name or path, as for `load`; its tables `dataset.press` and `dataset.session` say
    what is drawn. sweeps: how many, all in memory. seed: of all random numbers. rtol: the largest
    relative error of Rs and of Cp before the noise. Raises InputError where a number is out of
    range, ToleranceError where rtol cannot be kept.
    """
    from .simulator.dataset.memory import in_memory
    from .simulator.dataset.plan import Plan
    from .simulator.models.mechanics.in_depths import foldable

    return in_memory(Plan(foldable(_scene(scene), "a data set"), sweeps, seed, rtol))


def read(path: str | Path) -> xr.Dataset:
    """Sweeps from a file, simulated or measured; raises InputError in one line."""
    from .simulator.sweeps import read as read_sweeps

    return read_sweeps(path)


def write(
    sweeps: xr.Dataset,
    path: str | Path,
    *,
    overwrite: bool = False,
    overwrite_measured: bool = False,
) -> None:
    """Sweeps into a file, .nc, .csv or .zarr, whole or not at all.

    What a script wrote before is replaced with a note in the log. overwrite: replace also what was
    not made so. overwrite_measured: replace even measured sweeps. Raises InputError.
    """
    from .simulator.sweeps import write as write_sweeps
    from .simulator.sweeps.writing import Occasion, on_occasion

    now = Occasion(overwrite=overwrite, overwrite_measured=overwrite_measured)
    with on_occasion(now):
        write_sweeps(sweeps, path)


def plot(sweeps: xr.Dataset, path: str | Path) -> Path:
    """Rs and Cp of each press against frequency, and their changes from rest, as a picture.

    path: .png, .svg or .pdf; given back. Raises InputError for another ending or an absent folder.
    """
    from .simulator.check.curves import draw_curves

    return draw_curves([sweeps], path)


def features(
    sweeps: xr.Dataset, target: str = "column", quantities: str | Sequence[str] | None = None
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Features X, shape (sweep, feature), and targets y, (sweep,) or (sweep, 3) for positions.

    Of the sweeps whose press has such a target. target: column, row, pixel, pair, touches or
    position. quantities: such as "dlnZ,dphase", in one text or one by one; by default changes from
    the unpressed skin or, where most presses have no sweep of it before them, Rs and Cp. Raises
    InputError where these cannot be had.
    """
    from .localization.inputs.samples import samples_of

    samples = samples_of(_told_for(target, sweeps), target, quantities)
    return samples.X, samples.y


def train(sweeps: xr.Dataset, target: str = "column", **options: Any) -> Model:
    """A model that finds the `target` of sweeps like these.

    options: as of `rcskin.localization.model.training.train`; features by default as of `features`.
    Raises InputError where these cannot be had, or the sweeps are of one class.
    """
    from .localization.model.training import train as trained

    _check("train", options)
    return trained(_told_for(target, sweeps), target, **{"registry": _registry(), **options})


def load_model(path: str | Path) -> Model:
    """The model in a file that `rcskin train` or `rcskin adapt` wrote.

    Raises InputError in one line where the file holds none.
    """
    from .localization.model.file import load as loaded

    return loaded(path, _registry())


def _registry() -> Registry:
    """All estimators, those that invert the simulator too."""
    from .localization.inversion.registered import model_based
    from .localization.learners.registry import estimators
    from .simulator.inversion.tables import templates

    return estimators(model_based(templates))


def _model(given: Model | str | Path) -> Model:
    return load_model(given) if isinstance(given, str | Path) else given


def _told_for(target: str, sweeps: xr.Dataset) -> xr.Dataset:
    """With the factors that depths and forces stand for, where they are asked for."""
    from .localization.commands.asking import told_for
    from .simulator.measure.under_touches import factors_under

    return told_for(target, sweeps, factors_under)


def localize(
    model: Model | str | Path, sweeps: xr.Dataset, rest: xr.Dataset | None = None
) -> Answers:
    """The class or "cannot tell" of each sweep, how probable it is, and whether it is a novelty.

    model: or the path of its file. rest: sweeps of the unpressed skin, where the model needs them
    and they are not among `sweeps`. Raises InputError for sweeps unlike those trained on.
    """
    return _model(model).answers(sweeps, rest)


def evaluate(
    model: Model | str | Path, sweeps: xr.Dataset, rest: xr.Dataset | None = None
) -> dict[str, float]:
    """How often a model is right about sweeps whose presses are known: figures by their names.

    Such as "accuracy", the share of sweeps whose class was found, or "median error, mm" of
    positions. model, rest: as of `localize`. Sweeps that the model was trained or adapted on make
    the figures too good. Raises InputError for sweeps unlike those trained on.
    """
    from .localization.evaluation.evaluation import score

    model = _model(model)
    samples = model.samples(_told_for(model.target, sweeps), rest)
    return score(model.learned, samples).figures()


def reduce(scene: Scene | str | Path, rtol: float = 1e-4) -> Reduced:
    """A model of the scene's whole family of skins and presses that answers in microseconds.

    scene: or its name or path. Raises InputError for a scene that cannot be reduced, ToleranceError
    where rtol is out of reach.
    """
    from .simulator.models.reduced.greedy import reduce as reduced

    _check("reduce", {"rtol": rtol})
    return reduced(_scene(scene), rtol)


def limits(
    scene: Scene | str | Path, target: str = "column", **options: Any
) -> tuple[float, float]:
    """Share of sweeps that the best classifier of a known skin gets right, and its standard error.

    scene: or its name or path. target: column, row, pixel, pair or touches. options: as of
    `rcskin.simulator.limits.bayes_accuracy`, against the mean of three sweeps of the unpressed skin
    by default. Raises InputError for a meter without noise.
    """
    from .simulator.asked.options import RESTS
    from .simulator.limits import bayes_accuracy

    _check("limits", options)
    return bayes_accuracy(_scene(scene), target, **{"against_rest": RESTS, **options})


def calibrate(
    scene: Scene | str | Path, sweeps: xr.Dataset, *, anyway: bool = False
) -> Calibration:
    """The scene fitted to measured sweeps, with what the data tell of each parameter.

    scene: or its name or path. anyway: take sweeps of another skin too. Raises InputError where
    sweeps and scene do not fit, ToleranceError where no model holds.
    """
    from .simulator.calibration.run import calibrate as calibrated
    from .simulator.scene.files import scene_text
    from .simulator.sweeps.same_skin import check_same_skin

    scene = _scene(scene)
    if not anyway:
        check_same_skin(str(sweeps.attrs.get("scene", "")), scene_text(scene), "sweeps")

    return calibrated(scene, sweeps)
