"""The simulator's commands."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from .calibration.command import calibrate
from .check.command import check, plot
from .check.import_command import import_sweeps, join
from .dataset.command import dataset
from .describe.command import describe
from .design.command import design
from .limits.command import limits
from .limits.frequencies_command import frequencies
from .page.command import page
from .requests.options import SceneName, complete_scene
from .safe_text import say, terminal
from .view.command import view

VIRTUAL_EARTH = "virtual earth"
LOW_TERMINAL = "The meter's low terminal (virtual earth of an LCR meter, floating without earth)"

app = typer.Typer(
    name="rcskin",
    help="Simulate a capacitive soft sensor skin and localize touches on it.",
    no_args_is_help=True,
    suggest_commands=False,  # `requests/mistyped.py` does
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # text in brackets, such as the name of a table, stays as it is
    context_settings={"help_option_names": ["--help", "-h"]},
)


def _print_version(requested: bool) -> None:
    if requested:
        from importlib.metadata import version

        say(f"rcskin {version('rcskin')}")
        raise typer.Exit


@app.callback()
def common(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    """Simulate a capacitive soft sensor skin and localize touches on it."""


@app.command("help")
def help_of(
    command: Annotated[
        list[str] | None, typer.Argument(help="A command, such as sweep, or meter serve.")
    ] = None,
) -> None:
    """Show the help of a command, as COMMAND --help does."""
    app([*(command or []), "--help"], prog_name="rcskin", standalone_mode=False)


@app.command()
def scenes(
    name: Annotated[
        str | None,
        typer.Argument(help="Scene whose file is shown.", autocompletion=complete_scene),
    ] = None,
) -> None:
    """List the built-in scenes, or show the file of one."""
    from rich.table import Column, Table

    from .scene.scene_files import builtin_names, builtin_text, load_scene

    if name is not None:
        typer.echo(builtin_text(name), nl=False)
        return
    table = Table(Column("name", no_wrap=True), "skin (mm)", "frequencies", "description", box=None)
    for name in builtin_names():
        scene = load_scene(name)
        skin, f = scene.skin, scene.frequencies
        table.add_row(
            name,
            f"{1e3 * skin.length:.0f} x {1e3 * skin.width:.0f}",
            f"{len(f)}, {f[0] / 1e3:.3g}-{f[-1] / 1e3:.3g} kHz",
            scene.description,
        )
    terminal().print(table)


@app.command()
def keys() -> None:
    """List every key of a scene file with type, unit, default, range and meaning, as Markdown."""
    from .scene.key_listing import page

    typer.echo(page(), nl=False)


@app.command(epilog="Example: rcskin new my.toml --from glove")
def new(
    output: Annotated[Path, typer.Argument(help="MY.toml, a new file to edit.")],
    like: Annotated[
        str,
        typer.Option(
            "--from", help="The built-in scene to start from.", autocompletion=complete_scene
        ),
    ] = "glove",
    low: Annotated[
        str | None,
        typer.Option(
            help="The meter's low terminal: 'virtual earth' of an LCR meter, or 'floating' of a "
            "meter without earth. Default: prompted on a terminal, else a virtual earth.",
            autocompletion=lambda: ["virtual-earth", "floating"],
        ),
    ] = None,
) -> None:
    """Start a scene of your own: a commented file with every basic key and its unit."""
    from .scene.scene_files import checked_low, write_new

    if low is None and sys.stdin.isatty():
        low = typer.prompt(LOW_TERMINAL, default=VIRTUAL_EARTH)
    write_new(output, like, checked_low(low or VIRTUAL_EARTH))
    say(f"{output}: started from {like}; rcskin sweep {output} -o all.nc simulates it")


@app.command(epilog="Example: rcskin sweep sheet-5x5 -o all.nc")
def sweep(
    scene: SceneName,
    output: Annotated[Path, typer.Option("--output", "-o", help="OUT.csv or OUT.nc.")],
    press: Annotated[
        list[str] | None,
        typer.Option(
            help="ROW,COLUMN, rect(X,Y,WIDTH,HEIGHT), disc(X,Y,RADIUS) or poly(X1,Y1,X2,Y2,...), "
            "in m, X,Y the centre; then :FACTOR, a depth (:2mm), a force (:5N) or :touch; then "
            ":finger, :rod or a capacitance to earth (:5.3pF). '+' joins touches; 'none' is the "
            "unpressed skin. May be repeated. Default: the unpressed skin, then every pixel."
        ),
    ] = None,
    rtol: Annotated[
        float, typer.Option(help="Largest relative error of Rs and of Cp, 1e-8 to 1e-2.")
    ] = 1e-4,
    model: Annotated[
        str,
        typer.Option(
            help="auto, lumped, line, sheet or reduced.",
            autocompletion=lambda: ["auto", "lumped", "line", "sheet", "reduced"],
        ),
    ] = "auto",
    explain: Annotated[
        bool, typer.Option("--explain", help="Print which model solved each press, and why.")
    ] = False,
) -> None:
    """Simulate sweeps, noise-free, and write them with their estimated errors."""
    from .sweeps import checked_output, sizes_text, write

    checked_output(output)  # before the solvers are imported, which takes half a second
    from .measure.foam_state import describe_timing
    from .measure.simulate import answered, check_fits, gather
    from .models.mechanics.force_depths import depths_in_words
    from .models.solver import Solver, checked_model
    from .press.press import every_press, press_on
    from .progress import on_terminal, tracked
    from .requests.console import note, report_written
    from .requests.requested_scene import requested_scene, warn_of_model
    from .requests.time_estimates import with_time_estimate

    loaded = requested_scene(scene)
    warn_of_model(scene, loaded)
    presses = [
        press_on(loaded.parts.skin, loaded.press, text) for text in press or []
    ] or every_press(loaded.parts.skin, loaded.press)
    check_fits(loaded.parts.setup, len(presses))
    for line in describe_timing(loaded.parts):
        note(f"{scene}: {line}")
    solver = Solver(loaded.parts, rtol, checked_model(model))
    with on_terminal() as progress:
        announced = with_time_estimate(scene, tracked(presses, loaded.name, progress), len(presses))
        found = list(answered(solver, announced))
    sweeps = gather(solver, found)
    write(sweeps, output)
    if explain:
        for one_terminal in loaded.parts.driven_by_touch:
            say(f"wiring: {one_terminal}")
        for pressed, answer in found:
            say(*solver.explain(pressed, answer).splitlines())
    for line in depths_in_words(loaded.parts.skin, presses):
        note(line)
    report_written(sizes_text(sweeps.sizes), output)


app.command(epilog="Example: rcskin describe sheet-5x5 -o sheet.png")(describe)
app.command("import", epilog="Example: rcskin import eis.csv --press none -o eis.nc")(import_sweeps)
app.command(epilog="Example: rcskin join monday.nc tuesday.nc -o all.nc")(join)
app.command(epilog="Example: rcskin check all.nc -o report.png")(check)
app.command(epilog="Example: rcskin plot all.nc -o all.png")(plot)
app.command(epilog="Example: rcskin dataset sheet-5x5 --sweeps 2000 -o skins.zarr")(dataset)
app.command(epilog="Example: rcskin calibrate sheet-5x5 run.nc -o found")(calibrate)
app.command(epilog="Example: rcskin limits sheet-5x5 -o limits")(limits)
app.command(epilog="Example: rcskin frequencies sheet-5x5 -n 8")(frequencies)
app.command(epilog="Example: rcskin design sheet-5x5-two-interfaces --want 0.9 -o designed")(design)
app.command(epilog="Example: rcskin view sheet-5x5 --press 2,3 --frequency 1e4 -o field.png")(view)
app.command(epilog="Example: rcskin page sheet-5x5 -o skin.html")(page)


def with_short_help(commands: typer.Typer) -> None:
    """Makes lists of commands show the whole first paragraph of each command's help."""
    for each in commands.registered_commands:
        first, *_ = (getattr(each.callback, "__doc__", None) or "").split("\n\n")
        each.short_help = " ".join(first.split())
