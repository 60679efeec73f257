"""What a recording leaves: its output, written once from the journal, and never over another."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..options import Overwrite

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr

    from .journal import Entry, Header, Journal


def check_free(output: Path, overwrite: bool) -> None:
    """Raises InputError saying what is there, where it is not to be overwritten."""
    from ...simulator.sweeps import InputError

    if output.exists() and not overwrite:
        raise InputError(
            f"{output}: is there already{_held(output)}; --overwrite replaces it, or give another "
            "name"
        )


def finish(journal: Journal, header: Header, entries: Mapping[int, Entry]) -> xr.Dataset:
    """Write the output whole, then take the journal away; the sweeps that were written."""
    sweeps = _written(journal.output, header, entries)
    journal.remove()
    return sweeps


def gather_command(
    recording: Annotated[Path, typer.Argument(help="The output that the recording was to have.")],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Another OUT.nc or OUT.csv.")
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Write what a recording or a live session has so far, ended or under way.

    A recording can go on afterwards, towards another mounting's or its own end.
    """
    from ...simulator.sweeps import InputError, checked_output, counted
    from .journal import Journal

    journal = Journal(recording)
    header = journal.header()
    entries = journal.entries(header) if header else {}
    if header is None or not entries:
        raise InputError(f"{journal.folder}: holds no sweep of a recording")
    path = checked_output(output or recording)
    check_free(path, overwrite)
    sweeps = _written(path, header, entries)
    whole = f" of {len(header.order)}" if header.order else ""
    typer.echo(f"{len(entries)}{whole} sweeps: {counted(sweeps.sizes)} -> {path}")


def _written(output: Path, header: Header, entries: Mapping[int, Entry]) -> xr.Dataset:
    from ...simulator.sweeps import write
    from .dataset import gather

    sweeps = gather(header, [entries[number] for number in sorted(entries)])
    write(sweeps, output)
    return sweeps


def _held(output: Path) -> str:
    from ...simulator.sweeps import InputError, counted, read

    try:
        sweeps = read(output)
    except InputError:
        return " and holds no sweeps"
    begun = sweeps.attrs.get("begun")
    return f" with {counted(sweeps.sizes)}" + (f", begun {begun}" if begun else "")
