"""Simulated sweeps of a scene, noise-free or as measured; reduced models; files that are read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .requests.argument_types import path_of, refuse, scene_of, sweeps_of
from .requests.number_ranges import SEED
from .requests.options import EXACTNESS, SCENE
from .requests.request import Request, Writing, argument, called, function, option, typed
from .safe_text import say

if TYPE_CHECKING:
    import xarray as xr

    from .models.reduced.reduced_model import Reduced
    from .models.solver import ModelName
    from .press.press import Press
    from .requests.argument_types import Sweeps
    from .scene.scene import Scene


def load(scene: str | Path) -> Scene:
    """Load a scene.

    scene: the name of a built-in scene, or the path of a TOML file. Raises InputError in one line
    that names the file, the key, the value and the allowed range.
    """
    from .scene.scene_files import load_scene

    return load_scene(path_of(scene, "scene"))


def read(path: str | Path) -> xr.Dataset:
    """Read sweeps from a file, simulated or measured.

    path: .nc, .csv or .zarr. Raises InputError in one line if the file holds no sweeps.
    """
    return sweeps_of(path_of(path))


class Sweep(Writing, example="sweep sheet-5x5 -o all.nc"):
    """Simulate sweeps, noise-free, and write them with their estimated errors."""

    scene: Scene | str | Path = argument(SCENE)
    output: Path = typed("OUT.csv or OUT.nc.", "--output", "-o")
    presses: Sequence[str | Press] | None = option(
        "ROW,COLUMN, rect(X,Y,WIDTH,HEIGHT), disc(X,Y,RADIUS) or poly(X1,Y1,X2,Y2,...), "
        "in m, X,Y the centre; then :FACTOR, a depth (:2mm), a force (:5N) or :touch; then "
        ":finger, :rod or a capacitance to earth (:5.3pF). '+' joins touches; 'none' is the "
        "unpressed skin. May be repeated. Default: the unpressed skin, then every pixel.",
        "--press",
        kind=list[str],
        called='texts ("2,3", "1,1:1.5+4,4", "none") or objects `Press`; by default the unpressed '
        "skin, then every pixel.",
        default=None,
        kw_only=False,
    )
    rtol: float = option(EXACTNESS, default=1e-4)
    model: ModelName = option(
        "auto, lumped, line, sheet or reduced.",
        among=("auto", "lumped", "line", "sheet", "reduced"),
        called='"auto", "lumped", "line", "sheet" or "reduced".',
        default="auto",
    )
    explain: bool = typed("Print which model solved each press, and why.", default=False)

    def run(self) -> None:
        from .sweeps import checked_output, sizes_text, write

        checked_output(self.output)  # before the solvers are imported, which takes half a second
        from .measure.foam_state import describe_timing
        from .measure.simulate import answered, gather
        from .models.mechanics.force_depths import depths_in_words
        from .models.solver import Solver
        from .progress import on_terminal, tracked
        from .requests.console import note, report_written
        from .requests.requested_scene import requested_scene, warn_of_model
        from .requests.time_estimates import with_time_estimate

        name = str(self.scene)
        loaded = requested_scene(name)
        warn_of_model(name, loaded)
        presses = self._presses(loaded)
        for line in describe_timing(loaded.parts):
            note(f"{name}: {line}")
        solver = Solver(loaded.parts, self.rtol, self.model)
        with on_terminal() as progress:
            announced = with_time_estimate(
                name, tracked(presses, loaded.name, progress), len(presses)
            )
            found = list(answered(solver, announced))
        sweeps = gather(solver, found)
        write(sweeps, self.output)
        if self.explain:
            for one_terminal in loaded.parts.driven_by_touch:
                say(f"wiring: {one_terminal}")
            for pressed, answer in found:
                say(*solver.explain(pressed, answer).splitlines())
        for line in depths_in_words(loaded.parts.skin, presses):
            note(line)
        report_written(sizes_text(sweeps.sizes), self.output)

    def result(self) -> xr.Dataset:
        """Simulate noise-free sweeps of presses, with the estimated errors of Rs and Cp.

        On foam that creeps the presses follow each other in this order, as in a session.

        Raises InputError for a press that does not fit the scene, ToleranceError if rtol cannot be
        kept.
        """
        from .measure.simulate import simulate
        from .models.solver import Solver

        scene = scene_of(self.scene)
        presses = self._presses(scene)
        return simulate(Solver(scene.parts, self.rtol, self.model), presses)

    def _presses(self, scene: Scene) -> list[Press]:
        from .measure.simulate import check_fits
        from .press.press import Press, every_press, press_on

        given = [self.presses] if isinstance(self.presses, str | Press) else self.presses
        if given is None:
            given = every_press(scene.parts.skin, scene.press)
        if not isinstance(given, Sequence) or not all(
            isinstance(one, str | Press) for one in given
        ):
            refuse("presses", 'a list of texts such as "2,3" or of Press', self.presses)
        check_fits(scene.parts.setup, len(given))
        on = scene.parts.skin, scene.press
        return [press_on(*on, each) if isinstance(each, str) else each for each in given]


class Measured(Request):
    """The sweeps that a meter would show."""

    sweeps: Sweeps = argument("the sweeps or the path of their file.")
    seed: int = called("seed of the noise.", within=SEED, default=1)

    def result(self) -> xr.Dataset:
        """Add the noise and errors of the scene's meter to simulated sweeps, session by session.

        Raises InputError if the sweeps store no scene.
        """
        from .measure.simulate import read_by_meter
        from .scene.scene_files import scene_of_sweeps
        from .sweeps import InputError

        sweeps = sweeps_of(self.sweeps)
        scene = scene_of_sweeps(sweeps)
        if scene is None:
            raise InputError(
                "the sweeps store no scene; its `readout` is needed for the errors of the meter"
            )
        return read_by_meter(sweeps, scene.parts.meter, self.seed)


class Reduce(Request):
    """A reduced model of a scene."""

    scene: Scene | str | Path = argument(SCENE)
    rtol: float = option(EXACTNESS, default=1e-4, kw_only=False)

    def result(self) -> Reduced:
        """Train a reduced model of all skins and presses of the scene; it answers in microseconds.

        Raises InputError for a scene that cannot be reduced, ToleranceError if rtol is not reached.
        """
        from .models.reduced.greedy import reduce as reduced

        return reduced(scene_of(self.scene).parts, self.rtol)


sweep, measured, reduce = function(Sweep), function(Measured), function(Reduce)
