"""README of an exported data set, as the Hugging Face Hub shows it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ...safe_text import markdown_text
from .exported_sweeps import Exported


def write_card(
    folder: Path, exported: Exported, files: str, tags: Sequence[str], layout: Sequence[str]
) -> None:
    """Writes README.md. files: pattern of the data files. layout: lines on the columns."""
    description, episodes = exported.description(), len(exported.episodes)
    sweeps = exported.sweeps.sizes["sweep"]
    quantities = [
        f"- `{name}`: {meaning}, {description['units'][name]}"
        for name, meaning in description["quantities"].items()
    ]
    labels = [
        f"- `{name}`: {meaning}" + (f", {unit}" if unit not in ("", "1") else "")
        for name, meaning in description["labels"].items()
        for unit in [description["units"].get(name, "")]
    ]
    lines = [
        "---",
        "task_categories:",
        "- robotics",
        "tags:",
        *(f"- {tag}" for tag in tags),
        "configs:",
        "- config_name: default",
        f"  data_files: {files}",
        "---",
        "",
        f"# {markdown_text(exported.data.stem)}",
        "",
        f"Readings of a capacitive sensor skin: {sweeps} sweeps in {episodes} episodes, one for",
        f"each session. Written by {description['made_by']}.",
        "",
        "## Columns",
        "",
        *layout,
        "",
        "## Quantities",
        "",
        *quantities,
        "",
        f"Interfaces: {', '.join(map(markdown_text, exported.vector.interfaces))}.",
        "",
        f"Frequencies in Hz: {', '.join(f'{each:.10g}' for each in exported.vector.frequencies)}.",
        "",
        "## Labels",
        "",
        *labels,
        "",
        "## Time",
        "",
        f"{exported.clock.source[0].upper()}{exported.clock.source[1:]}.",
        "",
    ]
    (folder / "README.md").write_text("\n".join(lines), encoding="utf-8")
