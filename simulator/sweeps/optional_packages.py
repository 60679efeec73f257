"""Optional libraries, and the extra of this package that installs them."""

from importlib.util import find_spec
from pathlib import Path

from .errors import InputError


def require_packages(work: str | Path, extra: str, *libraries: str) -> None:
    """Raises InputError naming the install command if a library is not installed.

    work: what needs the libraries, in the user's words. extra: name of the extra of this package.
    """
    missing = [library for library in libraries if find_spec(library) is None]
    if missing:
        raise InputError(f"{work}: needs {', '.join(missing)}: pip install 'rcskin[{extra}]'")
