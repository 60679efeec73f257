"""The command `rcskin import`: measured sweeps from tables of other tools."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..requests.number_ranges import AllowedRange
from ..requests.request import Writing, argument, typed
from ..safe_text import say

if TYPE_CHECKING:
    from ..sweeps.importing.grouping import Defaults


class Join(Writing, example="join monday.nc tuesday.nc -o all.nc"):
    """Join recordings of one skin into one file, each mounting its own session.

    Sessions with the same name (`record --session NAME`) become one session.
    Every command that reads sweeps also accepts several files.
    """

    files: Sequence[Path] = argument("FILE.nc, FILE.zarr or FILE.csv.")
    output: Path = typed("OUT.nc, .csv or .zarr.", "--output", "-o")
    session: str | None = typed(
        "Name of the single mounting to which all of them belong.", default=None
    )

    def run(self) -> None:
        from ..requests.console import report_written
        from ..sweeps import checked_output, sizes_text, write
        from ..sweeps.joining import one_session, read_joined

        checked_output(self.output)
        sweeps = read_joined(self.files)
        if self.session is not None:
            sweeps = one_session(sweeps, self.session)
        write(sweeps, self.output)
        sessions = len(set(sweeps["session"].values.tolist()))
        session_count = f"{sessions} session{'' if sessions == 1 else 's'}"
        report_written(f"{sizes_text(sweeps.sizes)}, {session_count}", self.output)


class Import(Writing, example="import eis.csv --press none -o eis.nc"):
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

    files: Sequence[Path] = argument("Tables of other tools, joined in this order.")
    output: Path = typed("OUT.nc or OUT.csv.", "--output", "-o")
    press: Sequence[str] | None = typed(
        "The press of a file without a press column: 'none', ROW,COLUMN[:FACTOR] or any "
        "text. Give it once for all files, or once for each file.",
        default=None,
    )
    interface: Sequence[str] | None = typed(
        "The interface of a file without such a column, given once or for each file.", default=None
    )
    session: Sequence[int] | None = typed(
        "The session of a file without such a column, given once or for each file.",
        within=AllowedRange(0, 2**31 - 1, "the number of a session"),
        default=None,
    )
    branch: str = typed(
        "Branch of X if only Rs and Cp are given: followed, capacitive or resistive.",
        default="followed",
    )
    columns: str | None = typed(
        "Names of all columns in place of the header's, such as f,Rs,-X or "
        "'f (kHz),-,|Z|,phase (deg)'; '-' for a column that is not used.",
        default=None,
    )
    strict: bool = typed("Refuse a file with lines that are no readings.", default=False)

    def run(self) -> None:
        from ..requests.console import note, report_written, warn
        from ..sweeps import checked_output, sizes_text, write
        from ..sweeps.importing.branch import checked_branch
        from ..sweeps.imports import import_files

        checked_output(self.output)
        checked_branch(self.branch)
        defaults = _defaults(len(self.files), self.press, self.interface, self.session)
        sweeps = import_files(
            self.files, defaults, branch=self.branch, columns=self.columns, strict=self.strict
        )
        write(sweeps, self.output)
        name = f"{self.files[0]}: " if len(self.files) == 1 else ""
        say(f"{name}{sweeps.attrs['columns']}")
        if "left_out" in sweeps.attrs:
            note(f"{name}left out: {sweeps.attrs['left_out']}")
        if "warnings" in sweeps.attrs:
            warn(f"{name}{sweeps.attrs['warnings']}")
        if "branch_rule" in sweeps.attrs:
            say(f"{self.output}: {sweeps.attrs['branch_rule']}")
        if "branch_doubt" in sweeps.attrs:
            warn(f"{self.output}: {sweeps.attrs['branch_doubt']}; --branch chooses one")
        report_written(sizes_text(sweeps.sizes), self.output)


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
