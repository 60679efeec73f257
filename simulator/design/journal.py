"""What a search has found so far, on disk: one small file for each answer, each written whole."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..sweeps import InputError, whole_file

Answer = dict[str, Any]


class Journal:
    """Answers by what was asked. header: what all of them depend on, besides."""

    def __init__(self, folder: Path | None, header: Mapping[str, Any]) -> None:
        """folder: of the journal; None keeps nothing."""
        self._folder, self._header = folder, dict(header)

    def kept(self, asked: Mapping[str, Any], answer: Callable[[], Answer]) -> Answer:
        """The answer that is on disk, or else that of `answer`, which is then kept.

        Both pass through JSON, so that they are the same to the last bit. Raises InputError where
        the journal cannot be read or written.
        """
        if self._folder is None:
            return json.loads(json.dumps(answer()))
        text = json.dumps({"of": self._header, "asked": dict(asked)}, sort_keys=True)
        path = self._folder / f"{hashlib.sha256(text.encode()).hexdigest()[:24]}.json"
        try:
            if path.exists():
                return json.loads(path.read_text(encoding="utf-8"))
            found = json.dumps(answer())
            self._folder.mkdir(exist_ok=True)
            with whole_file(path) as unfinished:
                unfinished.write_text(found, encoding="utf-8")
            return json.loads(found)
        except (OSError, json.JSONDecodeError) as error:
            raise InputError(f"{path}: cannot be used as a journal: {error}") from error

    def done(self) -> None:
        """Nothing needs to be taken up again."""
        if self._folder is not None and self._folder.exists():
            shutil.rmtree(self._folder)
