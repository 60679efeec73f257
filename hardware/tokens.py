"""Access tokens of ports: drawn at each start, stored where only the user can read them."""

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
    """192 random bits as text that fits into URLs."""
    return secrets.token_urlsafe(24)


def same_token(given: object, token: str) -> bool:
    """True if a client gave the token. The time of the comparison reveals nothing."""
    text = given if isinstance(given, str) else ""
    return secrets.compare_digest(text.encode(errors="replace"), token.encode())


def token_file(port: int) -> Path:
    """File with the token of a control port, in the user's folder for program state.

    The file's name holds the computer's, because computers may share a home folder. Raises
    RuntimeError if the user has no home folder.
    """
    state = os.environ.get("LOCALAPPDATA") or os.environ.get("XDG_STATE_HOME") or ""
    folder = Path(state) if Path(state).is_absolute() else Path.home() / ".local" / "state"
    computer = re.sub(r"[^\w.-]", "_", platform.node())
    return folder / "rcskin" / f"control-{computer}-{port}"


@contextmanager
def stored_token(token: str, port: int) -> Iterator[None]:
    """Keep the token in its file while the block runs.

    Windows protects the user's folder by its access list, other systems by the file's mode. Raises
    OSError or RuntimeError if the file cannot be written.
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
    """Token of a control port of this computer; empty if this user has none."""
    try:
        with token_file(port).open(encoding="ascii") as file:
            text = file.read(1000)
    except (OSError, ValueError, RuntimeError):
        return ""
    return text if TOKEN.fullmatch(text) else ""
