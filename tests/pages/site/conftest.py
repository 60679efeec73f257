"""The built site: its folder, and a browser that opens it from a server and from the folder.

Run `python docs/site.py site`, then `RCSKIN_SITE=site pytest tests/pages/site`.
"""

import os
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

PHONE = {"width": 400, "height": 850}


class Handler(SimpleHTTPRequestHandler):
    """A server of files that prints nothing."""

    def log_message(self, *_):
        pass


@pytest.fixture(scope="session")
def site():
    """The folder of the built site."""
    folder = os.environ.get("RCSKIN_SITE")
    if not folder:
        pytest.skip("RCSKIN_SITE names no folder of a built site")
    return Path(folder).resolve(strict=True)


@pytest.fixture(scope="session")
def served(site):
    """The address of the site on a server of this machine."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, directory=str(site)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()


@pytest.fixture(params=["served", "folder"])
def address(request, site, served):
    """The address of the site, from a server and from the folder."""
    return served if request.param == "served" else site.as_uri()


@pytest.fixture
def open_page(chromium):
    """A function that opens an address; no error, message or request to elsewhere may follow."""
    opened = []

    def open_page(address, path="index.html", **options):
        page = chromium.new_context(**{"viewport": PHONE, **options}).new_page()
        page.complaints = []
        page.on("console", lambda message: _note_error(page, message))
        page.on("pageerror", lambda error: page.complaints.append(str(error)))
        page.on("requestfailed", lambda request: page.complaints.append(request.url))
        page.on("request", lambda request: _note_other(page, address, request.url))
        opened.append(page)
        page.goto(f"{address}/{path}")
        return page

    yield open_page
    for page in opened:
        page.context.close()
        assert page.complaints == []


def _note_error(page, message):
    if message.type in ("error", "warning"):
        page.complaints.append(message.text)


def _note_other(page, address, url):
    if not url.startswith((address, "data:", "blob:")):
        page.complaints.append(url)
