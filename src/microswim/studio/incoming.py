"""What comes in: the body of a request, limited, of the wanted type, with numbers that are sane."""

from __future__ import annotations

import json
from typing import Any

from starlette.requests import Request

from microswim import checks

LARGEST_BODY = 512 * 1024  #: bytes


class Refused(Exception):
    """A request that is not answered, with status and sentence."""

    def __init__(self, status: int, sentence: str) -> None:
        super().__init__(sentence)
        self.status = status


async def body_of(request: Request, wanted: str, largest: int) -> bytearray:
    """Return the body of a request of the wanted type, from a page of this studio.

    Raises
    ------
    Refused
        If another page asks, or it is of another type or too long.
    """
    origin, host = request.headers.get("origin"), request.headers.get("host", "")
    if origin is not None and origin.partition("://")[2] != host:
        raise Refused(403, "this page does not belong to this studio")
    if request.headers.get("content-type", "").partition(";")[0].strip() != wanted:
        raise Refused(415, f"send {wanted}")
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > largest:
            raise Refused(413, f"more than {largest // 1024} KiB; a spec is much smaller")
    return body


def said(body: bytes | bytearray, as_text: bool) -> Any:
    """Return a body as text, or as the JSON in it.

    Raises
    ------
    Refused
        If it is neither, or holds a number beyond all sizes.
    """
    try:
        text = body.decode("utf-8")
        read = {
            "parse_constant": _no_constant,
            "parse_float": _finite,
            "parse_int": _finite_integer,
        }
        return text if as_text else json.loads(text, **read)
    except UnicodeDecodeError:
        raise Refused(422, "the file is not UTF-8 text") from None
    except (ValueError, RecursionError):
        raise Refused(
            422, "the request is not valid JSON, or has a number beyond all sizes"
        ) from None


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is no number")


def _finite(text: str) -> float:
    value = float(text)
    if abs(value) > checks.LARGEST or 0.0 < abs(value) < checks.SMALLEST:
        raise ValueError(f"{text[:20]} is beyond all sizes")
    return value


def _finite_integer(text: str) -> int:
    _finite(text)
    return int(text)
