"""The page as one file: its modules, its style and its skin written into one another."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

SITE = Path(__file__).parent / "site"


def document(data: Mapping[str, Any]) -> str:
    """The page of a skin, as HTML that needs nothing beside it. data: of `packed`."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    rooms = FileSystemLoader(Path(__file__).parent)
    pages = Environment(loader=rooms, autoescape=True, undefined=StrictUndefined)
    modules = {f"rcskin/{path.stem}": _module(path) for path in sorted(SITE.glob("modules/*.js"))}
    return pages.get_template("page.jinja").render(
        name=data["name"],
        description=data["description"],
        style=(SITE / "style.css").read_text(encoding="utf-8"),
        modules=_within_script({"imports": modules}),
        data=_within_script(data),
    )


def _module(path: Path) -> str:
    return "data:text/javascript;base64," + base64.b64encode(path.read_bytes()).decode()


def _within_script(values: Any) -> str:
    """JSON that no text in it can end a script with."""
    return json.dumps(values, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
