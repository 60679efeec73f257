"""Write the pages of the reference that are made from the code.

Run: python docs/generate.py
"""

from __future__ import annotations

from pathlib import Path

from rcskin.benchmarks.pictures import gallery
from rcskin.docs import api, commands, meters, supports, the_code
from rcskin.simulator.scene import key_listing

HERE = Path(__file__).parent


def pages() -> dict[Path, str]:
    """The text of each page by its path."""
    return {
        gallery.PAGE: gallery.page(),
        HERE / "reference" / "keys.md": key_listing.page(),
        HERE / "reference" / "commands.md": commands.page(),
        HERE / "reference" / "meter-commands.md": meters.page(),
        HERE / "reference" / "api.md": api.page(),
        HERE / "reference" / "supports.md": supports.page(),
        the_code.PAGE: the_code.page(),
        the_code.PICTURE: the_code.picture(),
    }


if __name__ == "__main__":
    for path, text in pages().items():
        path.write_text(text, encoding="utf-8")
