"""Results of a search on disk, so that it can continue: one small file for each."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..sweeps import InputError, inputs, kept_file
from ..sweeps.digests import sealed_json, unsealed_json

Answer = dict[str, Any]
DIGITS = 9
"""Digits of merits after the point: far more than the draws resolve."""


class SearchJournal:
    """Stored results by query. header: settings that all of them depend on."""

    def __init__(self, folder: Path | None, header: Mapping[str, Any]) -> None:
        """folder: of the journal; None keeps nothing."""
        self._folder, self._header = folder, dict(header)

    def answer(self, query: Mapping[str, Any], compute: Callable[[], Answer]) -> Answer:
        """The stored result of a query, or else that of `compute`, which is then stored.

        Both pass through JSON and are rounded to DIGITS, because sums may round differently in
        another process. Raises InputError where the journal cannot be read or written.
        """
        if self._folder is None:
            return json.loads(json.dumps(rounded(compute())))
        text = json.dumps({"of": self._header, "query": dict(query)}, sort_keys=True)
        path = self._folder / f"{hashlib.sha256(text.encode()).hexdigest()[:24]}.json"
        try:
            if path.exists():
                return unsealed_json(inputs.text(path, inputs.JOURNAL))
        except (OSError, ValueError) as error:
            raise InputError(
                f"{path}: cannot be used as a journal: {error}; remove it to compute it again"
            ) from error
        found = sealed_json(rounded(compute()))
        try:
            self._folder.mkdir(exist_ok=True)
            with kept_file(path) as unfinished:
                unfinished.write_text(found, encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: cannot be used as a journal: {error}") from error
        return unsealed_json(found)

    def done(self) -> None:
        """Removes the journal of a finished search."""
        if self._folder is not None and self._folder.exists():
            shutil.rmtree(self._folder)


def rounded(answer: Any) -> Any:
    """A result with all its numbers rounded to DIGITS after the point."""
    if isinstance(answer, dict):
        return {name: rounded(part) for name, part in answer.items()}
    if isinstance(answer, list | tuple):
        return [rounded(part) for part in answer]
    return round(answer, DIGITS) if isinstance(answer, float) else answer
