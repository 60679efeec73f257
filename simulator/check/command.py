"""The commands `rcskin check` and `rcskin plot`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..requests.argument_types import sweeps_of, typed_paths
from ..requests.number_ranges import ERROR
from ..requests.request import OVERWRITE, Writing, argument, function, option, typed
from ..safe_text import say

if TYPE_CHECKING:
    import xarray as xr

    from ..requests.argument_types import Sweeps
    from ..scene.parts import Pressing, Skin
    from .sweep_curves import Quantity

TRANSFER = (
    "the meter's low terminal is a virtual earth, so that readings are transfer impedances; the "
    "laws of passive networks do not apply to them, and each reading is checked by itself"
)
CREEPS = (
    "the scene's foam creeps during a sweep, so that the skin differs between frequencies; laws "
    "between frequencies do not apply, and each reading is checked by itself"
)
SEVERAL_SOURCES = (
    "several sources drive the skin at once (`driven_with`), so that its gains follow no law of a "
    "passive network; each reading is checked by itself"
)
NO_PHASES = (
    "phases are unknown: only |V / V_s| <= 1, and that it does not increase with frequency, can be "
    "checked; Kramers-Kronig needs the phase"
)
PERHAPS_EARTH = (
    "a body or a finger that takes current to earth also breaks these laws if the meter's low "
    "terminal is a virtual earth"
)
FLAGGED = 1


class Check(Writing, example="check all.nc -o report.png"):
    """Check sweeps against the laws of passive RC networks; code 1 where one is broken.

    Re Z >= 0 and Im Z <= 0; Rs, Cp and Cs do not increase with frequency; and
    the nearest sum of R, L, C and RC elements, all >= 0, follows every reading
    within the noise (Kramers-Kronig). A gain V / V_s behind one series resistor
    obeys the same laws in place of Z, and |V / V_s| <= 1. A device that sends the
    same digits at all frequencies or in each sweep is named, and so is a reading
    that is ten times off.

    These laws need not hold if the meter's low terminal is a virtual earth and a
    body or a finger takes current to earth, nor if the foam creeps during a
    sweep. If the scene of the sweeps says so ([surroundings], [skin.foam]
    relaxation), each reading is checked by itself.
    """

    files: Sequence[Path] = argument("Sweeps: FILE.nc, FILE.zarr, or a CSV of any tool; joined.")
    output: Path | None = typed(
        "REPORT.png, .svg, .pdf, or a folder for chart and tables.", "--output", "-o", default=None
    )
    noise: float | None = typed(
        "Relative standard deviation of a reading, if known. Default: estimated from "
        "repeated sweeps of one press, or from the residuals, and at least in proportion to "
        "the scene's readout over frequency.",
        within=ERROR,
        default=None,
    )
    tolerance: float = typed(
        "Largest rms residual of the Kramers-Kronig fit, over |Z|.", within=ERROR, default=0.02
    )

    def run(self) -> int:
        from ..requests.console import note, warn
        from ..scene.scene_files import scene_of_sweeps
        from ..sweeps import InputError
        from ..sweeps.clock import backward_times
        from ..sweeps.examination import examine, with_faults
        from ..sweeps.gain_laws import examine_gains
        from ..sweeps.joining import join
        from ..sweeps.reading_noise import device_faults
        from .noise_profiles import noise_profiles
        from .report import checked_report, report_of, write_report

        report = None if self.output is None else checked_report(self.output)
        sweeps = join([_read(file) for file in self.files], self.files)
        gains, together, faults = "gain" in sweeps, False, []
        try:
            scene = scene_of_sweeps(sweeps)
            two_terminal = (
                scene is None
                or scene.parts.skin.two_terminal
                or not _current_bypasses_meter(scene.parts.skin, scene.press, sweeps)
            )
            creeps = scene is not None and _creeps(scene.parts.skin, sweeps)
            bound = two_terminal and not creeps
            together = (
                gains and scene is not None and any(each.driven_with for each in scene.interfaces)
            )
            bound = bound and not together
            faults = device_faults(sweeps, bound)
            profiles = noise_profiles(scene and scene.parts.meter, sweeps)
            laws = {"noise": self.noise, "tolerance": self.tolerance, "profiles": profiles}
            if gains:
                scale = max(each.source_scale for each in scene.interfaces) if scene else 1.0
                verdicts = examine_gains(sweeps, single_source=bound, source_scale=scale, **laws)
            else:
                verdicts = examine(sweeps, two_terminal=bound, **laws)
        except InputError as error:
            if faults:
                say(*map(str, faults), f"no other law was checked: {error}")
                return FLAGGED
            raise InputError(f"{', '.join(map(str, self.files))}: {error}") from error
        verdicts = [with_faults(each, faults) for each in verdicts]
        for each in backward_times(sweeps):
            warn(each)
        if not two_terminal:
            note(TRANSFER)
        if creeps:
            note(CREEPS)
        if together:
            note(SEVERAL_SOURCES)
        elif gains and "gain_phase" not in sweeps:
            note(NO_PHASES)
        found = report_of(verdicts)
        found.show()
        if report is not None:
            write_report(found, report)
        flagged = any(each.broken for each in verdicts)
        if flagged and bound and not gains:
            say(PERHAPS_EARTH)
        return FLAGGED if flagged else 0


def _creeps(skin: Skin, sweeps: xr.Dataset) -> bool:
    """True if the foam creeps under any press of the sweeps, and thus between their readings."""
    from ..sweeps.schema import UNPRESSED

    pressed = any(str(press) != UNPRESSED for press in sweeps["press"].values)
    return pressed and bool(skin.foam.relaxation)


def _current_bypasses_meter(skin: Skin, pressing: Pressing, sweeps: xr.Dataset) -> bool:
    """True if surroundings, or a finger that a press names, may divert current from the meter."""
    from ..press.press import press_on

    around = skin.around
    assert around is not None
    presses = {str(press) for press in sweeps["press"].values}
    fingers = any(press_on(skin, pressing, press).fingers for press in presses)
    return fingers or bool(around.body) or around.rim is not False or around.solved


def _read(file: Path) -> xr.Dataset:
    from ..requests.console import note, warn
    from ..sweeps import read
    from ..sweeps.imports import import_file

    if file.suffix in (".nc", ".zarr"):
        return read(file)
    sweeps = import_file(file)
    if "left_out" in sweeps.attrs:
        note(f"{file}: left out: {sweeps.attrs['left_out']}")
    if "warnings" in sweeps.attrs:
        warn(f"{file}: {sweeps.attrs['warnings']}")
    return sweeps


class Plot(Writing, example="plot all.nc -o all.png"):
    """Plot simulated or measured sweeps: Rs, Cp or gains, their changes, phase, Nyquist."""

    sweeps: Sweeps = argument(
        "FILE.nc, FILE.zarr or a CSV of any tool; drawn in one chart.",
        "files",
        called="the sweeps or the path of their file.",
    )
    path: str | Path = option(
        "OUT.png, .svg or .pdf; OUT.html is a page with zoom.",
        "--output",
        "-o",
        called=".png, .svg, .pdf or .html; the function returns it.",
        kw_only=False,
    )
    what: Sequence[Quantity] = option(
        "Rs, Cp, change-Rs, change-Cp, phase or nyquist, or gain, change-gain or phase of gains; "
        "may be repeated.",
        kind=list[str],
        called='any of "Rs", "Cp", "change-Rs", "change-Cp" (from the unpressed skin), "phase" and '
        '"nyquist"; by default Rs and Cp and, if the unpressed skin was measured, their changes.',
        default=(),
        kw_only=False,
    )
    overwrite: bool = option(OVERWRITE, default=False)

    def run(self) -> None:
        from ..requests.console import note, report_written
        from ..sweeps import sizes_text
        from .sweep_curves import MAX_DRAWN, checked_drawing, checked_quantities, draw

        checked_quantities(self.what)
        checked_drawing(self.path)
        files = typed_paths(self.sweeps)
        recordings = [_read(file) for file in files]
        draw(recordings, self.path, self.what, _names(files, recordings) if files[1:] else [])
        for file, sweeps in zip(files, recordings, strict=True):
            if (count := sweeps.sizes["sweep"]) > MAX_DRAWN:
                note(f"{file}: {MAX_DRAWN} of {count} sweeps are drawn at even steps")
        drawn = [sizes_text(each.sizes) for each in recordings]
        report_written(drawn[0] if len(drawn) == 1 else f"{len(drawn)} recordings", Path(self.path))

    def result(self) -> Path:
        """Plot quantities of each press against frequency, as a picture or as a page to zoom.

        Raises InputError for another ending, an absent folder, or a file that exists and may not
        be replaced.
        """
        from ..sweeps.output_files import replacing
        from .sweep_curves import draw

        with replacing(self.overwrite):
            return draw([sweeps_of(self.sweeps)], self.path, self.what)


plot = function(Plot)


def _names(files: Sequence[Path], recordings: Sequence[xr.Dataset]) -> list[str]:
    """Names of recordings in a legend, with their origin; file names if these are distinct."""
    from ..sweeps.schema import MEASURED, VIRTUAL

    short = [file.name for file in files]
    distinct = short if len(set(short)) == len(short) else [str(file) for file in files]
    names = []
    for name, sweeps in zip(distinct, recordings, strict=True):
        model, simulated = sweeps.attrs.get("model"), "rtol" in sweeps.attrs
        origin = model if model in (MEASURED, VIRTUAL) else "simulated" if simulated else ""
        names.append(f"{name} ({origin})" if origin else name)
    return names
