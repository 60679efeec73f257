"""Libraries that only some work needs, and the extra of this package that brings them."""

from importlib.util import find_spec
from pathlib import Path

from .errors import InputError


def require_packages(work: str | Path, extra: str, *libraries: str) -> None:
    """Raises InputError where a library is not installed, with the command that installs it.

    work: what needs the libraries, as its user calls it. extra: of this package.
    """
    missing = [library for library in libraries if find_spec(library) is None]
    if missing:
        raise InputError(f"{work}: needs {', '.join(missing)}: pip install 'rcskin[{extra}]'")
