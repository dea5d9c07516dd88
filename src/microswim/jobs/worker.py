"""One worker process: told what to call, it answers one job at a time and ends with its parent."""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

from microswim.errors import MachineError, MicroswimError

THREADS = ("OMP", "OPENBLAS", "MKL", "NUMBA", "NUMEXPR")
Heard = queue.SimpleQueue  # of (worker, what, value)


@dataclass(frozen=True)
class Lost:
    """Why a job has no answer though nothing is wrong with what was asked."""

    reason: str


def called(call: Callable[..., Any], job: tuple) -> Any:
    """Return ``call(*job)``, or `Lost` where the machine is at fault."""
    try:
        return call(*job)
    except (MachineError, MemoryError, OSError) as error:
        return Lost(in_words(error))


def in_words(error: BaseException) -> str:
    """Return what an error of the machine says, in one sentence."""
    if isinstance(error, MemoryError):
        return "not enough memory"
    return " ".join(str(error).split()) or type(error).__name__


class Worker:
    """A process that answers one job at a time.

    Parameters
    ----------
    call
        What to call with each job's arguments.
    heard
        Queue for ``(worker, what, value)``; what is ``"ready"`` once, then for each job ``"told"``
        any number of times and ``"done"`` or ``"failed"``; ``"died"`` at the end.
    tells
        Whether `call` takes, as its last argument, a function that sends a value here.
    threads
        Threads that the numerical libraries may use, all cores for None.
    """

    def __init__(
        self, call: Any, heard: Heard | None = None, *, tells: bool = False, threads: int | None = 1
    ) -> None:
        environment = dict(os.environ)
        if threads is not None:
            environment |= {f"{name}_NUM_THREADS": str(threads) for name in THREADS}
        environment["PYTHONPATH"] = os.pathsep.join(p or os.getcwd() for p in sys.path)
        self.heard: Heard = queue.SimpleQueue() if heard is None else heard
        self.ready = False
        self.process = subprocess.Popen(
            [sys.executable, "-c", f"from {__name__} import serve; serve()"],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        threading.Thread(target=self._listen, daemon=True).start()
        self._send((call, tells))

    def ask(self, *job: Any) -> None:
        """Send a job; the answer is heard later."""
        self._send(job)

    def stop(self) -> None:
        """End the process now."""
        self.process.kill()
        self.process.wait()
        with contextlib.suppress(OSError):
            self.process.stdin.close()  # type: ignore[union-attr]

    def _send(self, message: Any) -> None:
        frame = pickle.dumps(message)
        pipe = self.process.stdin
        assert pipe is not None
        with contextlib.suppress(OSError):  # that it died is heard
            pipe.write(len(frame).to_bytes(8, "big") + frame)
            pipe.flush()

    def _listen(self) -> None:
        pipe = self.process.stdout
        assert pipe is not None
        try:
            while True:
                what, value = pickle.load(pipe)
                if what == "ready":
                    self.ready = True
                self.heard.put((self, what, value))
        except Exception as error:  # the end of the pipe, or an answer that cannot be read
            self.process.kill()
            status = self.process.wait()
            pipe.close()
            why = f"exit status {status}" if isinstance(error, EOFError) else in_words(error)
            self.heard.put((self, "died", why))


def serve() -> None:
    """Answer jobs from stdin on stdout; the loop of a worker process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent
    jobs, out = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a solver prints must not end up among the answers
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    frames: queue.SimpleQueue = queue.SimpleQueue()
    threading.Thread(target=_receive, args=(jobs, frames), daemon=True).start()

    def say(what: str, value: Any) -> None:
        out.write(pickle.dumps((what, value)))
        out.flush()

    with contextlib.suppress(BrokenPipeError):
        call, tells = _loaded(frames.get(), say)
        more = (lambda value: say("told", value),) if tells else ()
        while True:
            frame = frames.get()
            with _ended_with(jobs):
                answer = _answered(call, frame, more)
            say(*answer)


def _loaded(frame: bytes, say: Callable[[str, Any], None]) -> Any:
    """Load what to call; what cannot be imported here is the answer to every job."""
    try:
        told = pickle.loads(frame)
    except Exception as error:
        sentence = f"a worker process cannot load it: {type(error).__name__}: {error}"
        told = partial(_refuse, sentence), False
    say("ready", None)
    return told


def _refuse(sentence: str, *_: Any) -> None:
    raise MicroswimError(sentence)


def _answered(call: Any, frame: bytes, more: tuple) -> tuple[str, Any]:
    try:
        return "done", called(call, (*pickle.loads(frame), *more))
    except MicroswimError as error:
        return "failed", error
    except Exception as error:
        return "failed", MicroswimError(f"{type(error).__name__}: {error}")


def _receive(jobs: Any, frames: queue.SimpleQueue) -> None:
    """Read jobs, and end this process when the parent is gone."""
    while True:
        size = jobs.read(8)
        frame = jobs.read(int.from_bytes(size, "big")) if len(size) == 8 else b""
        if not frame:
            os._exit(1)
        frames.put(frame)


@contextlib.contextmanager
def _ended_with(jobs: Any) -> Iterator[None]:
    """Let the kernel end this process when the parent closes the pipe, also in compiled code.

    Compiled code keeps the thread of `_receive` waiting. A pipe opened with ``O_ASYNC`` sends a
    signal when something happens to it; while a job is solved, that can only be its end.
    """
    if not hasattr(os, "O_ASYNC"):
        yield
        return
    import fcntl

    flags = fcntl.fcntl(jobs, fcntl.F_GETFL)
    fcntl.fcntl(jobs, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(jobs, fcntl.F_SETFL, flags | os.O_ASYNC)
    try:
        yield
    finally:
        fcntl.fcntl(jobs, fcntl.F_SETFL, flags)
