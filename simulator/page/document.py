"""Page as one file that contains its modules, its style and its skin."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..safe_text import template_environment

SITE = Path(__file__).parent / "site"


@dataclass(frozen=True)
class PageLink:
    """Link of a skin's page.

    kind: what it is linked to, `live` or `skin`. nonce: that of its scripts and styles.
    """

    kind: str
    nonce: str


def document(data: Mapping[str, Any], link: PageLink | None = None) -> str:
    """Page of a skin, as HTML that needs no other file.

    data: as from `packed`. link: that of a page that is served; without it the page forbids itself
    any.
    """
    folders = ("skin", "shown", "link") if link else ("skin", "shown")
    paths = [path for folder in folders for path in sorted(SITE.glob(f"{folder}/*.js"))]
    modules = {f"rcskin/{path.stem}": _module(path) for path in paths}
    styles = [SITE / "style.css", *([SITE / "link" / "link.css"] if link else [])]
    return (
        template_environment(Path(__file__).parent)
        .get_template("page.jinja")
        .render(
            name=data["name"],
            description=data["description"],
            style="".join(path.read_text(encoding="utf-8") for path in styles),
            modules=_within_script({"imports": modules}),
            data=_within_script(data),
            link=link,
            fingers=data.get("finger") is not None,
        )
    )


def _module(path: Path) -> str:
    return "data:text/javascript;base64," + base64.b64encode(path.read_bytes()).decode()


def _within_script(values: Any) -> str:
    """JSON in which no text can end a script."""
    return json.dumps(values, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
