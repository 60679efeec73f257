"""The simulator's commands."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from .calibration.command import Calibrate
from .check.command import Check, Plot
from .check.import_command import Import, Join
from .dataset.command import Dataset
from .describe.command import Describe
from .design.command import DesignSkin
from .limits.command import Limits
from .limits.frequencies_command import Frequencies
from .page.command import Page
from .requests.options import complete_scene
from .requests.request import Request, Writing, argument, typed
from .requests.typer_commands import add_commands
from .safe_text import say, terminal
from .simulation import Sweep
from .view.command import View

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


class Help(Request):
    """Show the help of a command, as COMMAND --help does."""

    command: Sequence[str] | None = argument(
        "A command, such as sweep, or meter serve.", default=None
    )

    def run(self) -> None:
        app([*(self.command or []), "--help"], prog_name="rcskin", standalone_mode=False)


class Scenes(Request):
    """List the built-in scenes, or show the file of one."""

    name: str | None = argument("Scene whose file is shown.", complete=complete_scene, default=None)

    def run(self) -> None:
        from rich.table import Column, Table

        from .scene.scene_files import builtin_names, builtin_text, load_scene

        if self.name is not None:
            typer.echo(builtin_text(self.name), nl=False)
            return
        table = Table(
            Column("name", no_wrap=True), "skin (mm)", "frequencies", "description", box=None
        )
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


class Keys(Request):
    """List every key of a scene file with type, unit, default, range and meaning, as Markdown."""

    def run(self) -> None:
        from .scene.key_listing import page

        typer.echo(page(), nl=False)


class New(Writing, example="new my.toml --from glove"):
    """Start a scene of your own: a commented file with every basic key and its unit."""

    output: Path = argument("MY.toml, a new file to edit.")
    like: str = typed(
        "The built-in scene to start from.", "--from", complete=complete_scene, default="glove"
    )
    low: str | None = typed(
        "The meter's low terminal: 'virtual earth' of an LCR meter, or 'floating' of a "
        "meter without earth. Default: prompted on a terminal, else a virtual earth.",
        complete=lambda: ["virtual-earth", "floating"],
        default=None,
    )

    def run(self) -> None:
        from .scene.scene_files import checked_low, write_new

        low = self.low
        if low is None and sys.stdin.isatty():
            low = typer.prompt(LOW_TERMINAL, default=VIRTUAL_EARTH)
        write_new(self.output, self.like, checked_low(low or VIRTUAL_EARTH))
        path = self.output
        say(f"{path}: started from {self.like}; rcskin sweep {path} -o all.nc simulates it")


add_commands(
    app,
    *(Help, Scenes, Keys, New, Sweep, Describe, Import, Join, Check, Plot, Dataset, Calibrate),
    *(Limits, Frequencies, DesignSkin, View, Page),
)
