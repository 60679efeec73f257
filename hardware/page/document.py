"""The document of a page: what it is made by, and how it is sent under a strict policy."""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, Protocol

from ..scene_data import SceneData

Kind = Literal["live", "skin"]
"""live: of measured sweeps and answers. skin: of a virtual one, which is pressed on the page."""


class MakeDocument(Protocol):
    """Writes the page of a scene as HTML; all of its scripts and styles carry the nonce.

    Raises InputError where the scene has no page.
    """

    def __call__(self, scene: SceneData, kind: Kind, nonce: str, /) -> str: ...


@dataclass(frozen=True)
class Document:
    """HTML with a stand-in wherever each answer puts a nonce of its own."""

    text: str
    stand_in: str

    @classmethod
    def made(cls, make: MakeDocument, scene: SceneData, kind: Kind) -> Document:
        """The document of a scene. Raises as `make`."""
        stand_in = secrets.token_urlsafe(16)
        return cls(make(scene, kind, stand_in), stand_in)

    def sent(self) -> tuple[Mapping[str, str], bytes]:
        """Headers and body of an answer."""
        nonce = secrets.token_urlsafe(16)
        policy = (
            "default-src 'none'",
            f"script-src 'nonce-{nonce}'",
            f"style-src 'nonce-{nonce}'",
            "connect-src 'self'",
            "img-src data:",
            "base-uri 'none'",
            "form-action 'none'",
            "frame-ancestors 'none'",
        )
        headers = {
            "Content-Type": "text/html; charset=utf-8",
            "Content-Security-Policy": "; ".join(policy),
            "Cross-Origin-Opener-Policy": "same-origin",
            "Cross-Origin-Resource-Policy": "same-origin",
        }
        return headers, self.text.replace(self.stand_in, nonce).encode()
