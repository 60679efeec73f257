"""Files of a report: tables as CSV, numbers as JSON, folders filled at once."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from glob import escape
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..cleanup import temporary_folder
from ..sweeps import InputError, made_folder, whole_file
from ..sweeps.csv_cells import write_cells
from ..sweeps.output_files import check_all_replaceable
from ..sweeps.writing import keep_beside

if TYPE_CHECKING:
    import pandas as pd


def write_text(path: Path, text: str) -> None:
    """Writes a text as UTF-8, whole or not at all."""
    with whole_file(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")


def write_json(path: Path, content: Any, indent: int = 2) -> None:
    """Writes numbers and texts as JSON. Raises ValueError if a number is not finite."""
    write_text(path, json.dumps(content, indent=indent, allow_nan=False) + "\n")


def write_rows(path: Path, header: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """Writes a header and rows as CSV; no text in it is a formula to a spreadsheet."""
    with whole_file(path) as unfinished, unfinished.open("w", newline="", encoding="utf-8") as file:
        write_cells(file, chain([header], rows))


def write_frame(path: Path, table: pd.DataFrame) -> None:
    """Writes a table of pandas as CSV, without its index."""
    with whole_file(path) as unfinished:
        table.to_csv(unfinished, index=False, lineterminator="\n")


@contextmanager
def filled_at_once(folder: Path) -> Iterator[Path]:
    """Folder for a report's files; they appear in `folder` at the end of the block.

    If the block fails, nothing appears. Raises InputError if `folder` cannot be made or one of the
    files may not be replaced; then the finished ones are in a folder of their own next to it.
    """
    with temporary_folder() as unfinished:
        yield unfinished
        made_folder(folder)
        try:
            check_all_replaceable(folder, map(escape, files_in(unfinished)))
        except InputError as error:
            raise InputError(f"{error}. {keep_beside(unfinished, folder)}") from error
        for name in files_in(unfinished):
            with whole_file(folder / name) as file:
                shutil.copyfile(unfinished / name, file)


def files_in(folder: str | Path) -> Sequence[str]:
    """Names of the files in a folder, in order."""
    return sorted(path.name for path in Path(folder).iterdir())
