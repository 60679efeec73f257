"""Check of the head of a request: valid HTTP/1.1 that asks for a page."""

from __future__ import annotations

import re
from http import HTTPStatus

MAX_HEAD = 8192
"""Bytes of request line and headers. Browsers send under 2 kB without cookies."""
METHODS = (b"GET", b"HEAD")
WORD = rb"[!#$%&'*+.^_`|~0-9A-Za-z-]+"
REQUEST = re.compile(rb"(%b) ([\x21-\x7e]+) HTTP/([0-9])\.([0-9])" % WORD)
HEADER = re.compile(rb"(%b):[ \t]*([\x20-\x7e\x80-\xff\t]*)" % WORD)
LINE, END = b"\r\n", b"\r\n\r\n"
BARE = re.compile(rb"(?<!\r)\n")


def is_decidable(received: bytes) -> bool:
    """True if these first bytes of a connection are a complete head, or surely an invalid one."""
    line, ended, _ = received.partition(LINE)
    return (
        END in received
        or len(received) > MAX_HEAD
        or BARE.search(received) is not None
        or (ended != b"" and _request_refusal(line) is not None)
    )


def refusal_status(head: bytes) -> HTTPStatus | None:
    """Status that refuses a head (up to its empty line); None if the head is accepted.

    Accepted are GET and HEAD without a body, in HTTP/1.1, with one Host (RFC 9112, sections 2 to
    6).
    """
    line, *headers = head.removesuffix(END).split(LINE)
    if len(head) > MAX_HEAD:
        return HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE
    sound = head.endswith(END) and _headers_are_valid(headers)
    return _request_refusal(line) or (None if sound else HTTPStatus.BAD_REQUEST)


def _request_refusal(line: bytes) -> HTTPStatus | None:
    request = REQUEST.fullmatch(line)
    if request is None:
        return HTTPStatus.BAD_REQUEST
    if request[1] not in METHODS:
        return HTTPStatus.METHOD_NOT_ALLOWED
    if (request[3], request[4]) != (b"1", b"1"):
        return HTTPStatus.HTTP_VERSION_NOT_SUPPORTED
    return None if request[2].startswith(b"/") else HTTPStatus.BAD_REQUEST


def _headers_are_valid(lines: list[bytes]) -> bool:
    """True if header lines are well-formed, name one host, and announce no body."""
    matches = [HEADER.fullmatch(line) for line in lines]
    if not all(matches):
        return False
    fields = [(match[1].lower(), match[2].strip()) for match in matches if match]
    bodies = ("transfer-encoding", "content-length")
    promised = {value for name, value in fields if name.decode() in bodies}
    return [name for name, _ in fields].count(b"host") == 1 and promised <= {b"0"}
