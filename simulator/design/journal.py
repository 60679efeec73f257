"""What a search has found so far, on disk: one small file for each answer, each written whole."""

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
"""Of shares, after the point: far more than any draw tells."""


class Journal:
    """Answers by what was asked. header: what all of them depend on, besides."""

    def __init__(self, folder: Path | None, header: Mapping[str, Any]) -> None:
        """folder: of the journal; None keeps nothing."""
        self._folder, self._header = folder, dict(header)

    def kept(self, asked: Mapping[str, Any], answer: Callable[[], Answer]) -> Answer:
        """The answer that is on disk, or else that of `answer`, which is then kept.

        Both are rounded to DIGITS, as sums may round differently from one process to another, and
        pass through JSON. Raises InputError where the journal cannot be read or written.
        """
        if self._folder is None:
            return json.loads(json.dumps(rounded(answer())))
        text = json.dumps({"of": self._header, "asked": dict(asked)}, sort_keys=True)
        path = self._folder / f"{hashlib.sha256(text.encode()).hexdigest()[:24]}.json"
        try:
            if path.exists():
                return unsealed_json(inputs.text(path, inputs.JOURNAL))
        except (OSError, ValueError) as error:
            raise InputError(
                f"{path}: cannot be used as a journal: {error}; remove it to have it found again"
            ) from error
        found = sealed_json(rounded(answer()))
        try:
            self._folder.mkdir(exist_ok=True)
            with kept_file(path) as unfinished:
                unfinished.write_text(found, encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: cannot be used as a journal: {error}") from error
        return unsealed_json(found)

    def done(self) -> None:
        """Nothing needs to be taken up again."""
        if self._folder is not None and self._folder.exists():
            shutil.rmtree(self._folder)


def rounded(answer: Any) -> Any:
    """The same with all its numbers rounded to DIGITS after the point."""
    if isinstance(answer, dict):
        return {name: rounded(part) for name, part in answer.items()}
    if isinstance(answer, list | tuple):
        return [rounded(part) for part in answer]
    return round(answer, DIGITS) if isinstance(answer, float) else answer
