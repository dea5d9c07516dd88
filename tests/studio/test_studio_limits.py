"""What a request to the studio may cost, and numbers at the edge of what can be computed."""

import asyncio
import copy
import json
import socket
import threading
import time
import tomllib

import pytest
import uvicorn
from test_studio import call

from microswim.errors import MicroswimError
from microswim.spec import presets
from microswim.studio import budget, maps, server
from microswim.studio.app import create_app

HELIX = tomllib.loads(presets.read("tabak/helix"))
X = {"field": "tail.amplitude", "from": 0.04, "to": 0.16, "count": 40}
Y = {"field": "tail.waves", "from": 2.0, "to": 4.0, "count": 40}


@pytest.fixture(scope="module")
def app():
    return create_app(HELIX, "helix", warm=False)


def changed(path, text):
    """Body of a request whose number at `path` is written as `text`."""
    tables = copy.deepcopy(HELIX)
    part, field = path.split(".")
    tables[part][field] = "HERE"
    return json.dumps({"tables": tables}).replace('"HERE"', text).encode()


@pytest.mark.parametrize(
    "text", ["1e308", "1e-308", "-1e308", "9" * 5000, "1" + "0" * 400, "1e999"]
)
@pytest.mark.parametrize(
    "path", ["fluid.viscosity", "tail.length", "tail.frequency", "body.radius"]
)
def test_no_number_is_a_failure_of_the_server(app, path, text):
    status, _, said = call(app, "POST", "/api/solve", changed(path, text))
    assert status in (200, 422), said
    if status == 422:
        assert said["error"]


@pytest.mark.parametrize("end", ["1e308", "1" + "0" * 400])
def test_no_range_of_a_map_is_a_failure_of_the_server(app, end):
    ask = {"tables": HELIX, "x": {**X, "to": "HERE"}, "y": Y}
    body = json.dumps(ask).replace('"HERE"', end).encode()
    status, _, said = call(app, "POST", "/api/map", body)
    assert status in (200, 422), said


def test_a_map_ends_at_its_time(monkeypatch):
    late = budget.Budget(seconds=0.0)
    with pytest.raises(MicroswimError, match="smaller map"):
        late.within(lambda ask: maps.map_(HELIX, X, Y), None)


def test_what_is_compiled_on_the_first_start_costs_no_request_its_time():
    asked = budget.Budget(seconds=0.2)
    with budget.uncounted():
        for _ in range(2):  # a second one, within
            with budget.uncounted():
                time.sleep(0.15)
        asked.within(lambda ask: budget.check(), None)
    asked.within(lambda ask: budget.check(), None)
    time.sleep(0.25)
    with pytest.raises(MicroswimError, match="takes more than"):
        asked.within(lambda ask: budget.check(), None)


def test_a_map_ends_when_nobody_waits_for_it(app, monkeypatch):
    pieces, true = [], maps.evaluate

    def slowly(*args, **options):
        pieces.append(1)
        time.sleep(0.5)
        return true(*args, **options)

    monkeypatch.setattr(maps, "evaluate", slowly)
    monkeypatch.setattr(maps, "PIECE", 400)
    body = json.dumps({"tables": HELIX, "x": X, "y": Y}).encode()
    sent = [
        {"type": "http.request", "body": body, "more_body": False},
        {"type": "http.disconnect"},
    ]
    scope = {
        "type": "http", "method": "POST", "path": "/api/map", "raw_path": b"/api/map",
        "headers": [(b"host", b"127.0.0.1"), (b"content-type", b"application/json")],
        "query_string": b"", "scheme": "http", "http_version": "1.1", "asgi": {"version": "3.0"},
        "client": ("127.0.0.1", 1), "server": ("127.0.0.1", 80), "root_path": "",
    }  # fmt: skip

    async def receive():
        return sent.pop(0) if sent else {"type": "http.disconnect"}

    async def send(message):
        """Nobody listens."""

    asyncio.run(app(scope, receive, send))
    assert len(pieces) < 4  # of which a map of 40 x 40 designs has so many


def test_who_knows_the_address_is_not_turned_away_before_the_server_runs():
    with server.listen("127.0.0.1", 0) as listener:
        socket.create_connection(listener.getsockname(), timeout=5.0).close()


def test_a_connection_without_a_request_is_closed(app, monkeypatch):
    monkeypatch.setattr(server, "PATIENCE", 0.2)
    listener = server.listen("127.0.0.1", 0)
    config = uvicorn.Config(app, log_level="error", lifespan="off", http=server.Patient)
    running = uvicorn.Server(config)
    thread = threading.Thread(target=running.run, kwargs={"sockets": [listener]}, daemon=True)
    thread.start()
    while not running.started:
        time.sleep(0.01)
    try:
        with socket.create_connection(listener.getsockname(), timeout=20.0) as silent:
            silent.sendall(b"GET / HT")
            assert silent.recv(1) == b""
    finally:
        running.should_exit = True
        thread.join()
