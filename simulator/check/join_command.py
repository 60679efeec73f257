"""The command `rcskin join`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


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
