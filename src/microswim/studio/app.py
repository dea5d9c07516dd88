"""The ASGI application: routes, limits, and errors as sentences.

It keeps nothing about who asks. The one thing with a life of its own is a job of the judge, known
by a token that only its owner has.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import json
import logging
import threading
import time
from collections.abc import AsyncIterator, Callable
from functools import partial
from typing import Any

import numpy as np
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from microswim.errors import MicroswimError, SpecError, writing
from microswim.models.rft.warm_up import warm_up
from microswim.spec import presets
from microswim.spec.writing import as_written
from microswim.studio import answers, magnet, maps, page
from microswim.studio import spec_tables as tables
from microswim.studio.brought import examples, films, scenes
from microswim.studio.brought import surfaces as dropped
from microswim.studio.budget import Budget, uncounted
from microswim.studio.exchange import exchanged
from microswim.studio.hosts import LOCAL, Hosts
from microswim.studio.incoming import LARGEST_BODY, Refused, body_of, said
from microswim.studio.judge import jobs as work
from microswim.studio.judge.processes import Judge
from microswim.studio.words import words
from microswim.swimmer.geometry.solids import reading

SLOWEST_BODY = 30.0  #: seconds until it is here
UNSEEN = 3.0  #: seconds that a page has to open before the kernels are compiled
KINDS = {"html": "text/html", "js": "text/javascript", "css": "text/css", "txt": "text/plain"}
SAFE = {
    "content-security-policy": "default-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; frame-ancestors 'none'",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cache-control": "no-cache",
}
#: What the page asks as soon as its script runs; the browser asks while it reads that.
SOON = ", ".join(
    f"</api/{name}>; rel=preload; as=fetch; crossorigin=anonymous" for name in ("start", "presets")
)
#: What numbers at the edge of the floating point make of a formula.
BEYOND = (OverflowError, FloatingPointError, MemoryError, np.linalg.LinAlgError)
log = logging.getLogger("microswim.studio")


def create_app(
    start: dict[str, Any], name: str, hosts: tuple[str, ...] = LOCAL, warm: bool = True
) -> Starlette:
    """Yield the application that serves the page.

    Parameters
    ----------
    start
        Tables of the spec that every new page shows first.
    name
        Its name.
    hosts
        Names under which the server may be reached; other Host headers are refused. ``"*"``
        stands for any address in numbers and for this machine's own names.
    warm
        Compile the kernels and start a judge in the background, at once.
    """
    judge = Judge()
    state = {"warm": not warm, "doing": "compiling the kernels"}
    seen = threading.Event()
    first = answers.solve(start, name)

    @contextlib.asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        if warm:
            work = partial(_warm, first["tables"], state, judge, seen)
            threading.Thread(target=work, daemon=True).start()
        yield
        judge.close()

    async def index(request: Request) -> Response:
        return file("index.html", request, {"link": SOON})

    async def static(request: Request) -> Response:
        return file(request.path_params["name"], request)

    def beginning(_: Any) -> Any:
        return {"name": name, "answer": first, "words": words()}

    def status(_: Any) -> Any:
        seen.set()
        return dict(state)

    routes = [
        Route("/", index),
        Route("/static/{name}", static),
        Route("/api/start", get(beginning)),
        Route("/api/status", get(status)),
        Route("/api/presets", get(_presets)),
        Route("/api/files/{name}", get(_example)),
        Route("/api/spec", post(_spec, as_text=True), methods=["POST"]),
        Route("/api/scene", post(scenes.read, as_text=True), methods=["POST"]),
        Route("/api/solve", post(_solve), methods=["POST"]),
        Route("/api/field", post(magnet.asked), methods=["POST"]),
        Route("/api/exchange", post(_exchange), methods=["POST"]),
        Route("/api/map", post(_map), methods=["POST"]),
        Route("/api/optimum", post(_optimum), methods=["POST"]),
        Route("/api/snapshot", post(_snapshot), methods=["POST"]),
        Route("/api/surface", dropping(_surface), methods=["POST"]),
        Route("/api/film", dropping(_film), methods=["POST"]),
        Route("/api/jobs", post(lambda ask: _start_job(judge, ask)), methods=["POST"]),
        Route("/api/jobs/{token}", get(lambda r: _job(judge, r)), methods=["GET"]),
        Route("/api/jobs/{token}", get(lambda r: _cancel(judge, r)), methods=["DELETE"]),
    ]
    trusted = Middleware(Hosts, hosts=hosts)
    return Starlette(routes=routes, middleware=[trusted], lifespan=lifespan)


def file(name: str, request: Request, more: dict[str, str] | None = None) -> Response:
    """Return one of the built files, or that the browser has it; no other file can be reached."""
    known = {"index.html", "studio.js", "studio.css", "licences.txt"}
    if name not in known:
        return JSONResponse({"error": f"there is no {name!r} here"}, 404)
    kind, text = KINDS[name.rpartition(".")[2]], page.text(name)
    tag = f'"{hashlib.sha256(text.encode()).hexdigest()[:32]}"'
    headers = {**SAFE, **(more or {}), "etag": tag}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    return Response(text, media_type=f"{kind}; charset=utf-8", headers=headers)


def get(answer: Callable[[Request], Any]) -> Callable[[Request], Any]:
    """Return the endpoint without a body."""

    async def endpoint(request: Request) -> Response:
        return await _answered(request, answer, request)

    return endpoint


def post(answer: Callable[[Any], Any], as_text: bool = False) -> Callable[[Request], Any]:
    """Return the endpoint that takes JSON, or text; other types and long bodies are refused."""
    wanted = "text/plain" if as_text else "application/json"

    async def read(request: Request) -> Any:
        return said(await body_of(request, wanted, LARGEST_BODY), as_text)

    return _endpoint(read, answer)


def dropping(answer: Callable[[Any], Any]) -> Callable[[Request], Any]:
    """Return the endpoint that takes a dropped file after a line of JSON, which has its name.

    The answer is called with what the line says and ``content``, the file.
    """

    async def read(request: Request) -> Any:
        body = await body_of(request, "application/octet-stream", dropped.LARGEST + LARGEST_BODY)
        head, _, content = body.partition(b"\n")  # what is asked, on a line, before the file
        return {**_object(said(head, False)), "content": bytes(content)}

    return _endpoint(read, answer)


def _endpoint(read: Callable[[Request], Any], answer: Callable[[Any], Any]) -> Any:
    async def endpoint(request: Request) -> Response:
        try:
            async with asyncio.timeout(SLOWEST_BODY):
                ask = await read(request)
        except TimeoutError:
            return JSONResponse({"error": "the request did not come to its end"}, 408)
        except Refused as refused:
            return JSONResponse({"error": str(refused)}, refused.status)
        in_units = writing(as_written(ask.get("tables") if isinstance(ask, dict) else None))
        budget = Budget()
        watch = asyncio.create_task(_gone(request, budget))
        try:
            with in_units:
                return await _answered(request, partial(budget.within, answer), ask)
        finally:
            watch.cancel()

    return endpoint


async def _gone(request: Request, budget: Budget) -> None:
    """Stop the work for a request when who asked no longer waits for it."""
    while not await request.is_disconnected():
        await asyncio.sleep(0.1)
    budget.stop()


async def _answered(request: Request, answer: Callable[[Any], Any], ask: Any) -> Response:
    try:
        made = await run_in_threadpool(answer, ask)
        text = None if isinstance(made, Response) else json.dumps(made, allow_nan=False)
    except BEYOND:
        sentence = "these numbers are too large or too small to be computed with; change them"
        return JSONResponse({"error": sentence}, 422)
    except SpecError as error:
        return JSONResponse({"error": str(error), "field": error.field}, 422)
    except MicroswimError as error:
        return JSONResponse({"error": str(error)}, 409)
    except Exception:
        log.exception("%s failed", request.url.path)
        sentence = "the studio failed on this; the terminal it runs in says why"
        return JSONResponse({"error": sentence}, 500)
    if isinstance(made, Response):
        return made
    return Response(text, media_type="application/json", headers=SAFE)


def _presets(_: Any) -> Any:
    specs = {n: presets.read(n) for n in presets.names()}
    return {"specs": specs, "scenes": scenes.shipped(), "files": examples.names()}


def _example(request: Request) -> Response:
    return _as_file(examples.content(f"files/{request.path_params['name']}"))


def _as_file(made: str | bytes) -> Response:
    return Response(made, media_type="application/octet-stream", headers=SAFE)


def _spec(text: str) -> Any:
    return answers.solve(tables.parse(text))


def _object(ask: Any) -> dict[str, Any]:
    if not isinstance(ask, dict):
        raise SpecError("the request must be a JSON object")
    return ask


def _solve(ask: Any) -> Any:
    return answers.solve(_object(ask).get("tables"), str(ask.get("name", "design"))[:80])


def _exchange(ask: Any) -> Any:
    return exchanged(_object(ask).get("tables"), ask.get("field"), ask.get("value"))


def _map(ask: Any) -> Any:
    return maps.map_(_object(ask).get("tables"), ask.get("x"), ask.get("y"), ask.get("output"))


def _optimum(ask: Any) -> Any:
    x, y = _object(_object(ask).get("x")), _object(ask.get("y"))
    return maps.optimum(ask.get("tables"), x, y, str(ask.get("output")))


def _snapshot(ask: Any) -> Response:
    return _as_file(page.snapshot(_object(ask).get("designs"), ask.get("map"), ask.get("view")))


def _surface(ask: Any) -> Any:
    token = dropped.keep(str(ask.get("name")), ask["content"])
    read = reading.read(dropped.place_of(token))
    corners = read.surface.points
    size = [float(x) for x in corners.max(axis=0) - corners.min(axis=0)]
    return {"file": token, "size": size, "faces": len(read.surface.faces), "notes": read.remarks}


def _film(ask: Any) -> Any:
    return films.read(str(ask.get("name")), ask["content"], ask)


def _start_job(judge: Judge, ask: Any) -> Any:
    kind = str(_object(ask).get("kind"))
    work.check(kind, ask)
    return {"token": judge.start(kind, ask)}


def _job(judge: Judge, request: Request) -> Any:
    job = judge.job(request.path_params["token"])
    return JSONResponse({"error": "there is no such job"}, 404) if job is None else job.status()


def _cancel(judge: Judge, request: Request) -> Any:
    judge.cancel(request.path_params["token"])
    return _job(judge, request)


def _compile(start: dict[str, Any]) -> None:
    warm_up()
    for name in ("tabak/helix", "tabak/plane_wave"):
        given = tables.parse(presets.read(name))
        answers.solve(given)
        x = {"field": "tail.amplitude", "from": 0.05, "to": 0.1, "count": 2}
        maps.map_(given, x, {"field": "tail.waves", "from": 2.0, "to": 3.0, "count": 2})
    answers.solve(start)


def _warm(
    start: dict[str, Any], state: dict[str, Any], judge: Judge, seen: threading.Event
) -> None:
    """Run everything once, so that the first slider is as quick as the hundredth.

    A page that opens comes first: the browser and this work want the same processors.
    """
    seen.wait(UNSEEN)
    begun = time.perf_counter()
    try:
        with uncounted():
            _compile(start)
        state["doing"] = "starting the judge"
        judge.warm()
    except Exception:
        log.exception("warming up failed")
    state.update(warm=True, doing="", seconds=time.perf_counter() - begun)
