"""The command `rcskin import`: measured sweeps from tables of other tools."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..safe_text import say

if TYPE_CHECKING:
    from ..sweeps.importing.grouping import Defaults


def join(
    files: Annotated[list[Path], typer.Argument(help="FILE.nc, FILE.zarr or FILE.csv.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="OUT.nc, .csv or .zarr.")],
    session: Annotated[
        str | None, typer.Option(help="Name of the single mounting to which all of them belong.")
    ] = None,
) -> None:
    """Join recordings of one skin into one file, each mounting its own session.

    Sessions with the same name (`record --session NAME`) become one session.
    Every command that reads sweeps also accepts several files.
    """
    from ..requests.console import report_written
    from ..sweeps import checked_output, sizes_text, write
    from ..sweeps.joining import one_session, read_joined

    checked_output(output)
    sweeps = read_joined(files)
    if session is not None:
        sweeps = one_session(sweeps, session)
    write(sweeps, output)
    sessions = len(set(sweeps["session"].values.tolist()))
    session_count = f"{sessions} session{'' if sessions == 1 else 's'}"
    report_written(f"{sizes_text(sweeps.sizes)}, {session_count}", output)


def import_sweeps(
    files: Annotated[
        list[Path], typer.Argument(help="Tables of other tools, joined in this order.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="OUT.nc or OUT.csv.")],
    press: Annotated[
        list[str] | None,
        typer.Option(
            help="The press of a file without a press column: 'none', ROW,COLUMN[:FACTOR] or any "
            "text. Give it once for all files, or once for each file."
        ),
    ] = None,
    interface: Annotated[
        list[str] | None,
        typer.Option(
            help="The interface of a file without such a column, given once or for each file."
        ),
    ] = None,
    session: Annotated[
        list[int] | None,
        typer.Option(
            help="The session of a file without such a column, given once or for each file."
        ),
    ] = None,
    branch: Annotated[
        str,
        typer.Option(
            help="Branch of X if only Rs and Cp are given: followed, capacitive or resistive."
        ),
    ] = "followed",
    columns: Annotated[
        str | None,
        typer.Option(
            help="Names of all columns in place of the header's, such as f,Rs,-X or "
            "'f (kHz),-,|Z|,phase (deg)'; '-' for a column that is not used."
        ),
    ] = None,
    strict: Annotated[
        bool,
        typer.Option("--strict", help="Refuse a file with lines that are no readings."),
    ] = False,
) -> None:
    """Import measured sweeps from tables of other tools.

    A table has named columns in any order, with units: a frequency, as
    `Frequency (kHz)` or `f/Hz`, and a pair that determines Z: Rs and X (`Z'`,
    `-Z''`), |Z| and phase (`theta (deg)`), G and B, Cp or Cs with D, Rs, Rp or
    Q, Ls and Rs, and others. All other columns that depend on Z must agree.

    Rs and Cp alone leave two solutions for X, X1 X2 = Rs^2. X is the one that
    a passive network has (Kramers-Kronig), followed even past -45 degrees, as
    sheets behave. If networks fit both, X starts with |X| >= Rs at the lowest
    frequency; a warning names readings where X may be wrong. `--branch
    capacitive` uses |X| >= Rs everywhere, `--branch resistive` |X| <= Rs. The
    attribute `branch_rule` states what was taken.

    Separators are comma, semicolon, tab or spaces; decimal commas, comments
    (# % ; !), lines above the header and text below the table are understood.
    Failed readings are left out, and the lines are named. Columns of a sweep,
    press, row, column, repetition, cycle, interface (or channel) or session
    label the lines; without them a sweep begins where the frequencies start
    over. Curves beside each other are sweeps.
    """
    from ..requests.console import note, report_written, warn
    from ..sweeps import checked_output, sizes_text, write
    from ..sweeps.importing.branch import checked_branch
    from ..sweeps.imports import import_files

    checked_output(output)
    checked_branch(branch)
    defaults = _defaults(len(files), press, interface, session)
    sweeps = import_files(files, defaults, branch=branch, columns=columns, strict=strict)
    write(sweeps, output)
    name = f"{files[0]}: " if len(files) == 1 else ""
    say(f"{name}{sweeps.attrs['columns']}")
    if "left_out" in sweeps.attrs:
        note(f"{name}left out: {sweeps.attrs['left_out']}")
    if "warnings" in sweeps.attrs:
        warn(f"{name}{sweeps.attrs['warnings']}")
    if "branch_rule" in sweeps.attrs:
        say(f"{output}: {sweeps.attrs['branch_rule']}")
    if "branch_doubt" in sweeps.attrs:
        warn(f"{output}: {sweeps.attrs['branch_doubt']}; --branch chooses one")
    report_written(sizes_text(sweeps.sizes), output)


def _defaults(
    files: int, press: Sequence | None, interface: Sequence | None, session: Sequence | None
) -> list[Defaults]:
    from ..sweeps.importing.grouping import Defaults

    given = {"press": press, "interface": interface, "session": session}
    spread = [_for_each(name, values, files) for name, values in given.items()]
    return [Defaults(*each) for each in zip(*spread, strict=True)]


def _for_each(name: str, values: Sequence[Any] | None, files: int) -> list[Any]:
    from ..sweeps import InputError

    values = values or [None]
    if len(values) not in (1, files):
        raise InputError(f"--{name} must be given once or {files} times, got {len(values)}")
    return list(values) * (files if len(values) == 1 else 1)
