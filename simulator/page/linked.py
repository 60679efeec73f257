"""Page of a skin that is linked to a meter; it is served, not written to a file."""

from __future__ import annotations

from ..models.mechanics.force_depths import pressed_by_factors
from ..progress import on_terminal
from ..scene.parts import SceneParts
from ..scene.supports import supported
from .document import PageLink, document
from .packed import page_data, reduced_for_page

RTOL, CELLS = 1e-3, 2


def linked_page(parts: SceneParts, kind: str, nonce: str) -> str:
    """Page, as HTML, of a scene with the interfaces and frequencies a meter reads.

    kind, nonce: those of `PageLink`. Raises InputError if the scene has no page.
    """
    pressed = pressed_by_factors(supported("a page that a meter feeds", parts), spread=False)
    with on_terminal() as progress:
        reduced = reduced_for_page(pressed, RTOL, CELLS, progress)
    return document(page_data(pressed, reduced), PageLink(kind, nonce))
