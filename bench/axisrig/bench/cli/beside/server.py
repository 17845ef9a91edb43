"""The page of a running campaign: a small server on 127.0.0.1 in threads of the command line.

It answers two addresses: `/` with the page, which needs nothing else, and `/states` with
server-sent events (HTML Living Standard, chapter "Server-sent events"), each a look as JSON, the
last one an event `end`.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread, current_thread
from typing import Any

from axisrig.bench.cli.beside.feed import Feed
from axisrig.reports.parts.shipped import shipped_text

HOST = "127.0.0.1"
SLOW_S = 2.0
"""A reader who takes nothing for so long has gone."""
PAUSES_MAX = 20
"""After so many pauses a look is sent although no state has come: the campaign may have gone on."""
_END_S = 1.0
# Nothing but what the page itself brings, and its events
_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline';"
    " connect-src 'self'; img-src data:; frame-ancestors 'none'"
)
_PACKAGE = "axisrig.bench.cli.beside"


def page() -> str:
    """Return the page; it loads nothing from anywhere."""
    text = shipped_text("page.html", _PACKAGE)
    style = shipped_text("style.css") + shipped_text("live.css", _PACKAGE)
    return text.replace("/* style */", style).replace(
        "/* script */", shipped_text("page.js", _PACKAGE)
    )


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    block_on_close = False

    def __init__(self, feed: Feed) -> None:
        self.feed, self.page = feed, page().encode()
        self.followers: list[Thread] = []
        super().__init__((HOST, 0), _Handler)

    def server_bind(self) -> None:
        """Take a free port; without the look at a name server of the class above."""
        self.socket.bind(self.server_address)
        self.server_address = self.socket.getsockname()
        self.server_name, self.server_port = HOST, self.server_address[1]

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A reader that goes away is nothing to report."""


class _Handler(BaseHTTPRequestHandler):
    server: _Server
    timeout = SLOW_S

    def do_GET(self) -> None:
        """Answer a request."""
        names = [f"{name}:{self.server.server_port}" for name in (HOST, "localhost")]
        if (
            self.headers.get("Host") not in names
        ):  # a page of somebody else, by a name for 127.0.0.1
            self.send_error(HTTPStatus.FORBIDDEN)
        elif self.path == "/":
            self._begin("text/html; charset=utf-8", len(self.server.page))
            self.wfile.write(self.server.page)
        elif self.path == "/states":
            self._send_states()
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def _begin(self, kind: str, length: int | None = None) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Cache-Control", "no-store")
        self.send_header("Content-Security-Policy", _POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        if length is not None:
            self.send_header("Content-Length", str(length))
        self.end_headers()

    def _send_states(self) -> None:
        """Send a look with each new state, at the latest after PAUSES_MAX pauses, until the end."""
        feed = self.server.feed
        self.server.followers.append(current_thread())
        self._begin("text/event-stream")
        number, pauses = -1, 0
        while not feed.has_ended:
            look = feed.look()
            if look.number != number or pauses >= PAUSES_MAX:
                number, pauses = look.number, 0
                self._send("look", look.as_json())
            feed.pause()
            pauses += 1
        self._send("end", feed.look().as_json())

    def _send(self, event: str, data: str) -> None:
        self.wfile.write(f"event: {event}\ndata: {data}\n\n".encode())

    def log_message(self, *_: object) -> None:
        """Write nothing to standard error."""


@contextmanager
def serving(feed: Feed) -> Iterator[str]:
    """Serve the page of a feed, on a free port; gives its address. Its end ends the feed.

    Raises OSError where no port can be had.
    """
    with _Server(feed) as server:
        thread = Thread(target=server.serve_forever, args=(0.1,), daemon=True, name="live page")
        thread.start()
        try:
            yield f"http://{HOST}:{server.server_port}/"
        finally:
            feed.end()
            server.shutdown()
            thread.join()
            for follower in server.followers:
                follower.join(_END_S)
