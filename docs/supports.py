"""The page of what goes with what, made from the table by which uses refuse features."""

from __future__ import annotations

from rcskin.simulator.scene.supports import FEATURES, USES

HEAD = """# What goes with what

`python docs/generate.py` writes this page from `simulator/scene/supports.py`. `rcskin solve` and
`rcskin sweep` take every feature of a scene. So do the other uses, except where a row below gives a
reason. A command or function that meets such a feature ends with the key and this reason.

| use | does not take | because |
| --- | --- | --- |
"""


def page() -> str:
    """The whole page, in Markdown."""
    rows = [
        f"| {use} | {FEATURES[feature][0]} | {reason} |"
        for use, cells in USES.items()
        for feature, reason in cells.items()
    ]
    return HEAD + "\n".join(rows) + "\n"
