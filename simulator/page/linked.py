"""The page of a skin that is linked to a meter: served, and not written to a file."""

from __future__ import annotations

from collections.abc import Sequence

from ..models.plain import evenly_pressed
from ..progress import on_terminal
from ..scene.files import parse_scene
from ..scene.reading import reading_at, through
from ..scene.scene import Scene
from .document import Link, document
from .packed import packed, reduced_for_page

RTOL, CELLS = 1e-3, 2


def linked_page(
    text: str,
    name: str,
    frequencies: Sequence[float],
    interfaces: Sequence[str],
    kind: str,
    nonce: str,
) -> str:
    """The page as HTML, of the scene in a text at some of its interfaces and at frequencies in Hz.

    name: of the text, as errors call it. kind, nonce: of `Link`. Raises InputError where the scene
    has no page.
    """
    scene = parse_scene(text, name)
    asked = _read_at(evenly_pressed(scene, "a page"), frequencies, interfaces)
    with on_terminal() as progress:
        reduced = reduced_for_page(asked, RTOL, CELLS, progress)
    return document(packed(asked, reduced), Link(kind, nonce))


def _read_at(scene: Scene, frequencies: Sequence[float], interfaces: Sequence[str]) -> Scene:
    """The scene as a meter reads it: its interfaces in their order, its frequencies."""
    return reading_at(through(scene, interfaces), frequencies)
