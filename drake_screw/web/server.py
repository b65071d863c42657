"""A web page of Meshcat with a panel of its own beside it, and messages to and fro.

Meshcat has buttons and sliders but no text. This serves Meshcat's own page with a panel added, on
a port of its own: everything else that the page asks for is passed on to Meshcat, and the scene
comes over Meshcat's web socket as ever.
"""

from __future__ import annotations

import http.client
import ipaddress
import json
import queue
import socket
import sys
import threading
import urllib.error
import urllib.request
from collections.abc import Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

from markupsafe import Markup

from drake_screw.errors import DrakeScrewError
from drake_screw.json_values import decode_json
from drake_screw.visualization.meshcat_page import add_to_page, render

WAIT = 20.0
"""s. For so long a page waits for a change before it asks again."""
LAST = 1.0
"""s. For so long the last state is kept for pages that do not ask for it just then."""

EVERYWHERE = ("0.0.0.0",)
"""Addresses that stand for all of this machine's."""

_DIRECT = urllib.request.build_opener(urllib.request.ProxyHandler({}))
_LARGEST = 1e9
"""No number of a message is larger."""


def check_address(host: str, port: int | None) -> None:
    """Find out whether a page can be served, before anything else is begun.

    Raises:
        DrakeScrewError: the port is taken or the address is not this machine's.
    """
    try:
        with socket.create_server((host, port or 0), reuse_port=False):
            pass
    except (OSError, OverflowError) as error:
        raise _unusable(host, port, error) from error


def warning(host: str) -> str | None:
    """What to warn of before a page is served on an address; None if only for this machine."""
    if _for_this_machine(host):
        return None
    return f"warning: served on {host} to everyone who can reach this machine, without a password"


def _for_this_machine(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _unusable(host: str, port: int | None, error: Exception) -> DrakeScrewError:
    return DrakeScrewError(
        f"cannot serve on {host}" + (f", port {port}" if port else "") + f": {error}",
        remedy="Choose another --host or --port; without them it is localhost and any free port.",
    )


class PanelServer:
    """Serves a panel beside Meshcat.

    Only `show`, `message` and `close` are for other threads than the server's; Meshcat itself is
    not touched here, as it may be used from one thread only.

    Args:
        meshcat_port: where Meshcat serves on this machine.
        panel: the panel.
        title: of the page.
        host: "localhost", or an address to listen on.
        port: to listen on; any free one if None.

    Raises:
        DrakeScrewError: the port is taken or the address is not this machine's.
    """

    def __init__(
        self,
        meshcat_port: int,
        panel: Markup,
        title: str,
        *,
        host: str = "localhost",
        port: int | None = None,
    ) -> None:
        self._state = b"{}"
        self._version = 0
        self._changed = threading.Condition()
        self._messages: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        self._closed = False
        self._private = _for_this_machine(host)
        self._waiting, self._sent = 0, 0
        here = "localhost" if host in EVERYWHERE else host
        meshcat = f"http://{here}:{meshcat_port}"
        server = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_GET(self) -> None:
                server._get(self, meshcat, panel, title)

            def do_POST(self) -> None:
                server._post(self)

            def log_message(self, format: str, *args: Any) -> None:
                pass

        try:
            self._server = _Server((host, port or 0), Handler)
        except (OSError, OverflowError) as error:
            raise _unusable(host, port, error) from error
        shown = socket.gethostname() if host in EVERYWHERE else host
        self.url = f"http://{shown}:{self._server.server_address[1]}/"
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def show(self, state: Mapping[str, Any]) -> None:
        """Give all open pages a new state."""
        text = json.dumps(state).encode()
        with self._changed:
            self._state, self._version = text, self._version + 1
            self._changed.notify_all()

    def message(self, timeout: float | None = None) -> dict[str, Any] | None:
        """The next message of a page, or None after so many seconds (None: wait)."""
        try:
            return self._messages.get(timeout=timeout)
        except queue.Empty:
            return None

    def close(self) -> None:
        """Stop serving the panel once open pages have the last state.

        Pages that were closed are not waited for. Meshcat itself serves until it ends.
        """

        def up_to_date() -> bool:
            return self._waiting == 0 and self._sent in (0, self._version)

        with self._changed:
            self._closed = True
            self._changed.notify_all()
            self._changed.wait_for(up_to_date, LAST)
        self._server.shutdown()
        self._server.server_close()

    def _get(
        self, request: BaseHTTPRequestHandler, meshcat: str, panel: Markup, title: str
    ) -> None:
        place = urlsplit(request.path)
        if place.path == "/state":
            given = parse_qs(place.query).get("after", ["0"])[0]
            after = int(given) if given.isdecimal() else 0
            with self._changed:
                self._waiting += 1
                self._changed.wait_for(lambda: self._closed or self._version > after, WAIT)
                version, new = self._version, self._version > after
                text = b'{"version":%d,"state":%b}' % (self._version, self._state) if new else b""
            try:
                _answer(request, 200 if new else 204, "application/json", text)
                request.close_connection |= self._closed  # or the page would ask for ever
            finally:
                with self._changed:
                    self._waiting -= 1
                    self._sent = version
                    self._changed.notify_all()
            return
        try:
            with _DIRECT.open(meshcat + request.path, timeout=WAIT) as answer:
                kind = answer.headers.get("Content-Type", "application/octet-stream")
                content = answer.read()
        except (OSError, ValueError, http.client.HTTPException) as error:
            code = getattr(error, "code", 502)
            _answer(request, code, "text/plain", str(error).encode())
            return
        if place.path in ("/", "/index.html"):
            port = str(urlsplit(meshcat).port)
            head = render("drake_screw.web", "web_socket.html.j2", port=port)
            content = add_to_page(content.decode(), panel, title=title, head=head).encode()
        _answer(request, 200, kind, content)

    def _post(self, request: BaseHTTPRequestHandler) -> None:
        """Takes a message of the page.

        Other sites' pages cannot send this type without being asked about it first, nor by giving
        their own name to this machine's address.
        """
        name = urlsplit(f"//{request.headers.get('Host', '')}").hostname or ""
        if self._private and not _for_this_machine(name):
            _answer(request, 403, "text/plain", b"this page is for localhost")
            return
        if request.headers.get("Content-Type") != "application/json":
            _answer(request, 415, "text/plain", b"expected application/json")
            return
        try:
            message = decode_json(request.rfile.read(int(request.headers["Content-Length"])))
        except (ValueError, TypeError):
            message = None
        if not isinstance(message, dict) or not all(map(_plain, message.values())):
            _answer(request, 400, "text/plain", b"expected a JSON object of words and numbers")
            return
        self._messages.put(message)
        _answer(request, 204, "text/plain", b"")


def _plain(value: Any, deep: int = 4) -> bool:
    """Whether a value may stand in a message: a word, nothing, or numbers of a sensible size."""
    if isinstance(value, list):
        return deep > 0 and all(_plain(one, deep - 1) for one in value)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return -_LARGEST <= value <= _LARGEST
    return value is None or isinstance(value, str)


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A page that was closed is no error."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


def _answer(request: BaseHTTPRequestHandler, code: int, kind: str, content: bytes) -> None:
    request.send_response(code)
    request.send_header("Content-Type", kind)
    request.send_header("Content-Length", str(len(content)))
    request.send_header("Cache-Control", "no-store")
    request.end_headers()
    try:
        request.wfile.write(content)
    except (BrokenPipeError, ConnectionResetError):
        request.close_connection = True
