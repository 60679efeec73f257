"""The command `rcskin view`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..requests.options import SceneName

if TYPE_CHECKING:
    from ..progress import ProgressCallback
    from .scenery import ViewedPress


def view(
    scene: SceneName,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="OUT.png .svg .pdf .gif .mp4 .vtu or .xdmf.")
    ],
    press: Annotated[
        str, typer.Option(help="A press as for `rcskin sweep`; default: the unpressed skin.")
    ] = "none",
    frequency: Annotated[
        list[float] | None,
        typer.Option(help="Hz; repeatable. Default: one of the interface's, or all."),
    ] = None,
    interface: Annotated[
        str | None, typer.Option(help="Interface of the scene; default: the first.")
    ] = None,
    what: Annotated[
        str,
        typer.Option(
            help="potential, phase, current, power, sensitivity-Rs, sensitivity-Cp, capacitance, "
            "deformation or all."
        ),
    ] = "potential",
    rtol: Annotated[
        float, typer.Option(help="Largest relative error of Rs and of Cp, 1e-8 to 1e-2.")
    ] = 1e-4,
    wrapped: Annotated[
        bool | None,
        typer.Option("--wrapped/--flat", help="Draw the skin in space or flat; default: as it is."),
    ] = None,
    exaggerate: Annotated[
        float | None, typer.Option(help="Factor on the drawn deflection; default: chosen.")
    ] = None,
    animate: Annotated[
        str | None, typer.Option(help="frequency or phase, for OUT.gif and OUT.mp4.")
    ] = None,
) -> None:
    """Show the fields of a skin: pictures, movies, files for ParaView.

    For several frequencies a picture has one panel each, a movie one frame each;
    VTU holds all fields at all frequencies, and XDMF has frequency for time.
    In SVG and PDF the fields are pixels, axes and words are lines.

    Potentials, currents and power are those for 1 V at the terminals.
    """

    _check(output, what, animate, exaggerate)
    every = animate == "frequency" or output.suffix in ALL_FREQUENCIES
    from dataclasses import replace

    from ..progress import on_terminal
    from ..requests.console import note, report_written
    from .outputs import write_output

    every = every and animate != "phase"
    with on_terminal() as progress:
        stage = _viewed_press(scene, press, frequency, interface, rtol, every, progress)
    stage = replace(stage, wrapped=wrapped, exaggeration=exaggerate)
    with on_terminal() as progress:
        write_output(output, stage, what, animate, progress, note)
    shown = what if output.suffix not in ALL_FIELDS else "all fields"
    report_written(f"{shown} of press {stage.press_text} at {_frequencies_text(stage)}", output)


ALL_FIELDS = (".vtu", ".xdmf")
ALL_FREQUENCIES = (".gif", ".mp4", ".vtu", ".xdmf")


def _check(output: Path, what: str, animate: str | None, exaggerate: float | None) -> None:
    from ..sweeps import InputError, checked_output
    from .outputs import ANIMATIONS, ENDINGS, MOVIES, check_output
    from .quantities import checked_name

    checked_name(what)
    check_output(checked_output(output, ENDINGS))
    if animate is not None and animate not in ANIMATIONS:
        raise InputError(f"--animate must be {' or '.join(ANIMATIONS)}, got {animate!r}")
    if animate is not None and output.suffix not in MOVIES:
        raise InputError(f"--animate needs -o OUT{' or OUT'.join(MOVIES)}")
    if exaggerate is not None and not (math.isfinite(exaggerate) and exaggerate >= 0):
        raise InputError(f"--exaggerate must be finite and >= 0, got {exaggerate:g}")


def _viewed_press(
    name: str,
    press: str,
    frequency: list[float] | None,
    interface: str | None,
    rtol: float,
    every: bool,
    progress: ProgressCallback,
) -> ViewedPress:
    from ..models.solution_fields import fields
    from ..press.press import press_on
    from ..requests.console import note, warn
    from ..requests.requested_scene import requested_scene
    from ..sweeps import InputError
    from .scenery import ViewedPress

    scene = requested_scene(name)
    pressed = press_on(scene.parts.skin, scene.press, press)
    chosen = scene.parts.setup.checked_name(interface)
    wiring = next(each for each in scene.interfaces if each.name == chosen)
    if wiring.driven_with:
        raise InputError(
            f"{name}: view shows the field of one source, and interface {chosen!r} is "
            "`driven_with` others; leave that key out here"
        )
    if interface is None and len(scene.interfaces) > 1:
        names = ", ".join(each.name for each in scene.interfaces)
        note(f"{name}: shows interface {chosen} of {names}; --interface selects another")
    frequencies = _frequencies(frequency, scene.parts.setup.frequency_at(chosen).tolist(), every)
    for one_terminal in scene.parts.driven_by_touch:
        if one_terminal.interface == chosen:
            warn(f"{name}: {one_terminal}")
    for key in scene.skin.foam.in_time:
        note(f"{name}: fields are those at the moment of the press, before `{key}` has an effect")
    found = fields(
        scene.parts.skin,
        scene.parts.setup,
        pressed,
        frequencies,
        chosen,
        rtol,
        progress,
    )
    return ViewedPress(scene.parts, pressed, wiring, found)


def _frequencies(requested: list[float] | None, known: list[float], every: bool) -> list[float]:
    """Frequencies to show, Hz, ascending: the requested ones, else all or one.

    Without a request it is all known ones if `every`, else the one in their middle.
    """
    from ..sweeps import InputError

    for frequency in requested or []:
        if not (math.isfinite(frequency) and frequency > 0):
            raise InputError(f"--frequency must be finite and > 0 Hz, got {frequency:g}")
    if requested or every:
        return sorted(set(requested or known))
    middle = math.sqrt(known[0] * known[-1])
    return [min(known, key=lambda each: abs(math.log(each / middle)))]


def _frequencies_text(stage: ViewedPress) -> str:
    from ..sweeps.units import prefixed

    frequencies = stage.fields.frequency
    one = len(frequencies) == 1
    return prefixed(frequencies[0], "Hz") if one else f"{len(frequencies)} frequencies"
