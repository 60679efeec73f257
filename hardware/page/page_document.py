"""HTML document of a page, sent with a strict content security policy."""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from ...simulator.scene.parts import SceneParts

Kind = Literal["live", "skin"]
"""live: shows measured sweeps and answers. skin: presses a virtual skin."""


@dataclass(frozen=True)
class PageDocument:
    """HTML with a placeholder that each response replaces by a new nonce."""

    text: str
    placeholder: str

    @classmethod
    def of(cls, parts: SceneParts, kind: Kind) -> PageDocument:
        """Document of a skin and its setup. Raises InputError as `linked_page`."""
        from ...simulator.page.linked import linked_page

        placeholder = secrets.token_urlsafe(16)
        return cls(linked_page(parts, kind, placeholder), placeholder)

    def sent(self) -> tuple[Mapping[str, str], bytes]:
        """Headers and body of a response."""
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
        return headers, self.text.replace(self.placeholder, nonce).encode()
