"""Page of a virtual meter: its address and its document."""

from __future__ import annotations

import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import TYPE_CHECKING, Literal
from urllib.parse import parse_qs, urlsplit

from ..tokens import new_token, same_token

if TYPE_CHECKING:
    from ...simulator.scene.parts import SceneParts

LOOPBACK = "127.0.0.1"
NAMES = (LOOPBACK, "localhost")
PAGE, LINK = "/", "/link"


@dataclass(frozen=True)
class PageAddress:
    """A port of the loopback, and the token in the page's address."""

    port: int
    token: str = field(default_factory=new_token, repr=False)

    @property
    def url(self) -> str:
        """URL to open in a browser."""
        return f"http://{LOOPBACK}:{self.port}{PAGE}?token={self.token}"

    def refusal_status(
        self, target: str, hosts: Sequence[str], origins: Sequence[str]
    ) -> HTTPStatus | None:
        """Status that refuses a request; None if the request is accepted.

        target: path and query of the request. hosts, origins: all its Host and Origin headers. Host
        must name this machine, against DNS rebinding. Origin must be this page; a link needs one.
        """
        try:
            parts = urlsplit(target)
            tokens = parse_qs(parts.query, max_num_fields=8).get("token", [])
        except ValueError:
            return HTTPStatus.BAD_REQUEST
        hosted = [f"{name}:{self.port}" for name in NAMES]
        own = [f"http://{host}" for host in hosted]
        if len(hosts) != 1 or hosts[0] not in hosted:
            return HTTPStatus.FORBIDDEN
        if any(origin not in own for origin in origins) or len(origins) > 1:
            return HTTPStatus.FORBIDDEN
        if parts.path == LINK and not origins:
            return HTTPStatus.FORBIDDEN
        if len(tokens) != 1 or not same_token(tokens[0], self.token):
            return HTTPStatus.FORBIDDEN
        return None if parts.path in (PAGE, LINK) else HTTPStatus.NOT_FOUND


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
