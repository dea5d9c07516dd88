"""Serve the studio on this machine."""

from __future__ import annotations

import contextlib
import socket
import threading
import webbrowser
from collections.abc import Callable
from typing import Any

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from microswim.errors import MicroswimError
from microswim.studio.app import create_app
from microswim.studio.hosts import LOCAL

PORT = 8642
PATIENCE = 30.0  #: seconds that a connection may stay open without a whole request
MOST_CONNECTIONS = 200


class Patient(H11Protocol):
    """HTTP connections that are closed when no request comes, or only half of one."""

    def connection_made(self, transport: Any) -> None:
        super().connection_made(transport)
        self.loop.call_later(PATIENCE, self._close_if_silent)

    def _close_if_silent(self) -> None:
        if self.cycle is None and not self.transport.is_closing():
            self.transport.close()


def listen(host: str, port: int | None) -> socket.socket:
    """Return a listening socket; without a port, 8642 or, where that is taken, any free one.

    Raises
    ------
    MicroswimError
        If the address cannot be had.
    """
    wanted = [PORT, 0] if port is None else [port]
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    for attempt in wanted:
        listener = socket.socket(family, socket.SOCK_STREAM)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((host, attempt))
            listener.listen()  # who reads the address at once waits and is not turned away
        except OSError as error:
            listener.close()
            if attempt == wanted[-1]:
                raise MicroswimError(
                    f"cannot listen on {host}:{attempt}: {error.strerror or error}; "
                    "choose another with --port"
                ) from None
            continue
        return listener
    raise MicroswimError(f"cannot listen on {host}")


def address(host: str, listener: socket.socket) -> str:
    """Return where the page is."""
    shown = f"[{host}]" if ":" in host else host
    return f"http://{shown}:{listener.getsockname()[1]}/"


def serve(
    tables: dict[str, Any],
    name: str,
    *,
    host: str = "127.0.0.1",
    port: int | None = None,
    browser: bool = True,
    ready: Callable[[str], None] | None = None,
) -> None:
    """Serve the page until interrupted.

    Parameters
    ----------
    tables, name
        The spec that a new page shows.
    host, port
        Where to listen; this machine only by default.
    browser
        Open the page.
    ready
        Called with the address once it is known.
    """
    listener = listen(host, port)
    where = address(host, listener)
    app = create_app(tables, name, hosts=LOCAL if host in LOCAL else ("*", host))
    config = uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        lifespan="on",
        http=Patient,
        limit_concurrency=MOST_CONNECTIONS,
    )
    if ready is not None:
        ready(where)
    if browser:
        threading.Timer(0.6, webbrowser.open, [where]).start()
    with contextlib.suppress(KeyboardInterrupt):
        uvicorn.Server(config).run(sockets=[listener])
