"""The judge in processes of its own: boundary elements with progress, cancelled at once.

A job is known by a token that only who started it holds, so that browser tabs share nothing. A
worker waits for the next job after it is done; one that is cancelled or forgotten is ended.
"""

from __future__ import annotations

import queue
import secrets
import threading
import time
from typing import Any

from microswim.errors import MicroswimError
from microswim.jobs.worker import Lost, Worker
from microswim.studio.judge import jobs as work

MOST_RUNNING = 2
MOST_KEPT = 40
FORGOTTEN = 60.0  #: seconds after which a job that nobody asks about is ended


class Job:
    """One question to the judge."""

    def __init__(self, kind: str, question: dict[str, Any]) -> None:
        self.kind, self.question = kind, question
        self.state, self.done, self.total = "running", 0, 1
        self.answer: Any = None
        self.asked = self.started = time.monotonic()
        self.cancelled = threading.Event()

    def status(self) -> dict[str, Any]:
        """Return what the page is told."""
        self.asked = time.monotonic()
        told = {"state": self.state, "done": self.done, "total": self.total}
        told["seconds"] = self.asked - self.started
        if self.state == "done":
            told["answer"] = self.answer
        elif self.state == "failed":
            told["error"] = self.answer
        return told


class Judge:
    """Jobs and the workers that do them."""

    def __init__(self) -> None:
        self._jobs: dict[str, Job] = {}
        self._idle: list[Worker] = []
        self._lock = threading.Lock()

    def warm(self) -> None:
        """Start one worker."""
        worker = hired()
        with self._lock:
            self._idle.append(worker)

    def start(self, kind: str, question: dict[str, Any]) -> str:
        """Begin a job; returns its token.

        Raises
        ------
        MicroswimError
            If the judge is busy.
        """
        with self._lock:
            if sum(j.state == "running" for j in self._jobs.values()) >= MOST_RUNNING:
                raise MicroswimError(
                    f"the judge is busy with {MOST_RUNNING} designs already; wait or cancel one"
                )
            for token in list(self._jobs)[: max(0, len(self._jobs) - MOST_KEPT)]:
                if self._jobs[token].state != "running":
                    del self._jobs[token]
            token, job = secrets.token_urlsafe(16), Job(kind, question)
            self._jobs[token] = job
        threading.Thread(target=self._follow, args=(job,), daemon=True).start()
        return token

    def job(self, token: str) -> Job | None:
        """Return the job of a token, if there is one."""
        return self._jobs.get(token)

    def cancel(self, token: str) -> None:
        """End a job at once."""
        job = self._jobs.get(token)
        if job is not None and job.state == "running":
            job.state = "cancelled"
            job.cancelled.set()

    def close(self) -> None:
        """End every worker."""
        with self._lock:
            tokens, idle, self._idle = list(self._jobs), self._idle, []
        for token in tokens:
            self.cancel(token)
        for worker in idle:
            worker.stop()

    def _follow(self, job: Job) -> None:
        with self._lock:
            worker = self._idle.pop() if self._idle else None
        worker = worker or hired()
        worker.ask(job.kind, job.question)
        if self._listen(job, worker):
            with self._lock:
                self._idle.append(worker)
        else:
            worker.stop()

    def _listen(self, job: Job, worker: Worker) -> bool:
        """Take messages until the job is over; whether the worker can go on."""
        while not job.cancelled.is_set():
            if time.monotonic() - job.asked > FORGOTTEN:
                job.state = "cancelled"
                return False
            try:
                _, what, value = worker.heard.get(timeout=0.05)
            except queue.Empty:
                continue
            if what == "told":
                job.done, job.total = value
            elif what in ("done", "failed", "died"):
                outcome, job.answer = _outcome(what, value)
                if not job.cancelled.is_set():
                    job.state = outcome
                return what != "died"
        return False


def hired() -> Worker:
    """Return a process of the judge, which may use all cores."""
    return Worker(work.answer, tells=True, threads=None)


def _outcome(what: str, value: Any) -> tuple[str, Any]:
    if what == "done" and not isinstance(value, Lost):
        return value
    if what == "died":
        return "failed", "the judge's process ended unexpectedly, perhaps for lack of memory"
    return "failed", value.reason if isinstance(value, Lost) else str(value)
