"""The command `rcskin view`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..requests.number_ranges import HERTZ, AllowedRange
from ..requests.options import EXACTNESS, SCENE
from ..requests.request import Writing, argument, typed

if TYPE_CHECKING:
    from ..progress import ProgressCallback
    from .scenery import ViewedPress


class View(Writing, example="view sheet-5x5 --press 2,3 --frequency 1e4 -o field.png"):
    """Show the fields of a skin: pictures, movies, files for ParaView.

    For several frequencies a picture has one panel each, a movie one frame each;
    VTU holds all fields at all frequencies, and XDMF has frequency for time.
    In SVG and PDF the fields are pixels, axes and words are lines.

    Potentials, currents and power are those for 1 V at the terminals.
    """

    scene: str = argument(SCENE)
    output: Path = typed("OUT.png .svg .pdf .gif .mp4 .vtu or .xdmf.", "--output", "-o")
    press: str = typed(
        "A press as for `rcskin sweep`; default: the unpressed skin.", default="none"
    )
    frequency: Sequence[float] | None = typed(
        "Hz; repeatable. Default: one of the interface's, or all.", within=HERTZ, default=None
    )
    interface: str | None = typed("Interface of the scene; default: the first.", default=None)
    what: str = typed(
        "potential, phase, current, power, sensitivity-Rs, sensitivity-Cp, capacitance, "
        "deformation or all.",
        default="potential",
    )
    rtol: float = typed(EXACTNESS, default=1e-4)
    wrapped: bool | None = typed(
        "Draw the skin in space or flat; default: as it is.", "--wrapped/--flat", default=None
    )
    exaggerate: float | None = typed(
        "Factor on the drawn deflection; default: chosen.",
        within=AllowedRange(0.0, 1e9, "times: a nanometre becomes a metre"),
        default=None,
    )
    animate: str | None = typed("frequency or phase, for OUT.gif and OUT.mp4.", default=None)

    def run(self) -> None:
        _check(self.output, self.what, self.animate)
        every = self.animate == "frequency" or self.output.suffix in ALL_FREQUENCIES
        from dataclasses import replace

        from ..progress import on_terminal
        from ..requests.console import note, report_written
        from .outputs import write_output

        every = every and self.animate != "phase"
        with on_terminal() as progress:
            stage = _viewed_press(
                self.scene, self.press, self.frequency, self.interface, self.rtol, every, progress
            )
        stage = replace(stage, wrapped=self.wrapped, exaggeration=self.exaggerate)
        with on_terminal() as progress:
            write_output(self.output, stage, self.what, self.animate, progress, note)
        shown = self.what if self.output.suffix not in ALL_FIELDS else "all fields"
        report_written(
            f"{shown} of press {stage.press_text} at {_frequencies_text(stage)}", self.output
        )


ALL_FIELDS = (".vtu", ".xdmf")
ALL_FREQUENCIES = (".gif", ".mp4", ".vtu", ".xdmf")


def _check(output: Path, what: str, animate: str | None) -> None:
    from ..sweeps import InputError, checked_output
    from .outputs import ANIMATIONS, ENDINGS, MOVIES, check_output
    from .quantities import checked_name

    checked_name(what)
    check_output(checked_output(output, ENDINGS))
    if animate is not None and animate not in ANIMATIONS:
        raise InputError(f"--animate must be {' or '.join(ANIMATIONS)}, got {animate!r}")
    if animate is not None and output.suffix not in MOVIES:
        raise InputError(f"--animate needs -o OUT{' or OUT'.join(MOVIES)}")


def _viewed_press(
    name: str,
    press: str,
    frequency: Sequence[float] | None,
    interface: str | None,
    rtol: float,
    every: bool,
    progress: ProgressCallback,
) -> ViewedPress:
    from ..models.heterogeneous.elements_model import Elements
    from ..press.press import press_on
    from ..requests.console import note, warn
    from ..requests.requested_scene import requested_scene
    from ..scene.supports import require
    from .scenery import ViewedPress

    scene = requested_scene(name)
    pressed = press_on(scene.parts.skin, scene.press, press)
    chosen = scene.parts.setup.checked_name(interface)
    wiring = next(each for each in scene.interfaces if each.name == chosen)
    require("a view of the field", scene.parts.skin, scene.parts.setup.of([chosen]))
    if interface is None and len(scene.interfaces) > 1:
        names = ", ".join(each.name for each in scene.interfaces)
        note(f"{name}: shows interface {chosen} of {names}; --interface selects another")
    frequencies = _frequencies(frequency, scene.parts.setup.frequency_at(chosen).tolist(), every)
    for one_terminal in scene.parts.driven_by_touch:
        if one_terminal.interface == chosen:
            warn(f"{name}: {one_terminal}")
    for key in scene.skin.foam.in_time:
        note(f"{name}: fields are those at the moment of the press, before `{key}` has an effect")
    model = Elements(scene.parts.skin, scene.parts.setup)
    found = model.fields(pressed, frequencies, chosen, rtol, progress)
    return ViewedPress(scene.parts, pressed, wiring, found)


def _frequencies(requested: Sequence[float] | None, known: list[float], every: bool) -> list[float]:
    """Frequencies to show, Hz, ascending: the requested ones, else all or one.

    Without a request it is all known ones if `every`, else the one in their middle.
    """
    if requested or every:
        return sorted(set(requested or known))
    middle = math.sqrt(known[0] * known[-1])
    return [min(known, key=lambda each: abs(math.log(each / middle)))]


def _frequencies_text(stage: ViewedPress) -> str:
    from ..sweeps.units import prefixed

    frequencies = stage.fields.frequency
    one = len(frequencies) == 1
    return prefixed(frequencies[0], "Hz") if one else f"{len(frequencies)} frequencies"
