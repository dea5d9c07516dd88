"""Who is meant by a request: only names of this machine are answered.

A page elsewhere can make its own name point at this machine (DNS rebinding); its requests carry
that name, not ours. An address in numbers cannot be rebound.
"""

from __future__ import annotations

import ipaddress
import socket
from typing import Any

from starlette.datastructures import Headers
from starlette.responses import JSONResponse

LOCAL = ("127.0.0.1", "localhost", "::1")


def name_of(host: str) -> str:
    """Return the name in a Host header, without port and brackets; empty if it makes no sense."""
    host = host.strip().lower()
    if host.startswith("["):
        inside, bracket, port = host[1:].partition("]")
        return inside if bracket and _is_port(port) else ""
    name, colon, port = host.partition(":")
    return name.rstrip(".") if _is_port(colon + port) else ""


def _is_port(text: str) -> bool:
    return text == "" or (text[0] == ":" and text[1:].isascii() and text[1:].isdigit())


def is_known(name: str, hosts: tuple[str, ...]) -> bool:
    """Return whether a name is one of the hosts; ``"*"``: any address, and this machine's own
    names.
    """
    if not name or name in hosts:
        return bool(name)
    if "*" not in hosts:
        return False
    own = socket.gethostname().lower()
    if name in {*LOCAL, own, own.partition(".")[0], f"{own.partition('.')[0]}.local"}:
        return True
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


class Hosts:
    """Middleware that refuses what is addressed to another name."""

    def __init__(self, app: Any, hosts: tuple[str, ...]) -> None:
        self.app, self.hosts = app, tuple(h.lower() for h in hosts)

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Answer, or refuse with a sentence."""
        if scope["type"] in ("http", "websocket"):
            name = name_of(Headers(scope=scope).get("host", ""))
            if not is_known(name, self.hosts):
                sentence = "this studio does not answer to that name; open the address it printed"
                await JSONResponse({"error": sentence}, 400)(scope, receive, send)
                return
        await self.app(scope, receive, send)
