"""Secrets that show who may steer: drawn anew at each start, and kept where only the user reads."""

from __future__ import annotations

import os
import platform
import re
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

TOKEN = re.compile(r"[\w-]{1,200}", re.ASCII)


def new_token() -> str:
    """192 random bits as text for URLs: not to be guessed by trying."""
    return secrets.token_urlsafe(24)


def same_token(given: object, token: str) -> bool:
    """Whether what a client gave is the token, compared in a time that tells nothing of it."""
    text = given if isinstance(given, str) else ""
    return secrets.compare_digest(text.encode(errors="replace"), token.encode())


def token_file(port: int) -> Path:
    """File with the token of a control port of this computer, in the user's folder for states.

    The name holds the computer's, because several may share a home folder. Raises RuntimeError
    where the user has no home folder.
    """
    state = os.environ.get("LOCALAPPDATA") or os.environ.get("XDG_STATE_HOME") or ""
    folder = Path(state) if Path(state).is_absolute() else Path.home() / ".local" / "state"
    computer = re.sub(r"[^\w.-]", "_", platform.node())
    return folder / "rcskin" / f"control-{computer}-{port}"


@contextmanager
def stored_token(token: str, port: int) -> Iterator[None]:
    """The token in its file while the block runs.

    Windows protects the user's folder by its access list; elsewhere the mode does. Raises OSError
    or RuntimeError where the file cannot be written.
    """
    path = token_file(port)
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    created = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(created, "w", encoding="ascii") as file:
        file.write(token)
    try:
        yield
    finally:
        if read_token(port) == token:
            with suppress(OSError):
                path.unlink()


def read_token(port: int) -> str:
    """The token of a control port of this computer; empty where this user has none."""
    try:
        with token_file(port).open(encoding="ascii") as file:
            text = file.read(1000)
    except (OSError, ValueError, RuntimeError):
        return ""
    return text if TOKEN.fullmatch(text) else ""
