"""Where a page is served, and who may ask for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from http import HTTPStatus
from urllib.parse import parse_qs, urlsplit

from ..tokens import new_token, same_token

LOOPBACK = "127.0.0.1"
NAMES = (LOOPBACK, "localhost")
PAGE, LINK = "/", "/link"


@dataclass(frozen=True)
class PageAddress:
    """A port of the loopback, and the token that a page's address carries."""

    port: int
    token: str = field(default_factory=new_token, repr=False)

    @property
    def url(self) -> str:
        """What is opened in a browser."""
        return f"http://{LOOPBACK}:{self.port}{PAGE}?token={self.token}"

    def refusal_status(
        self, target: str, hosts: Sequence[str], origins: Sequence[str]
    ) -> HTTPStatus | None:
        """Why a request is refused; None where it is not.

        target: path and query as asked. hosts, origins: all headers of those names. Host must be
        this machine by its own name, against pages that rebind theirs to it; Origin must be this
        page, and be there where a link is opened.
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
