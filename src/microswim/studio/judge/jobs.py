"""What a worker of the judge does, and what becomes of what goes wrong in it."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

from microswim.errors import MicroswimError, SpecError, writing
from microswim.spec.writing import as_written
from microswim.studio.judge import flow, pair_flow, path, together, verdict
from microswim.studio.spec_tables import swimmer_of

LEVELS = ("coarse", "standard", "fine")
KINDS: dict[str, Callable[..., dict[str, Any]]] = {
    "judge": verdict.judge,
    "flow": flow.flow,
    "pair_flow": pair_flow.pair_flow,
    "path": path.path,
    "together": together.together,
}


def answer(kind: str, question: dict[str, Any], tell: Callable[[Any], None]) -> tuple[str, Any]:
    """Return ``"done"`` and the answer to a question, or ``"failed"`` and why; tell progress."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with writing(as_written(question.get("tables"))):
                return "done", KINDS[kind](question, lambda i, n: tell((i, n)))
    except MicroswimError as error:
        return "failed", str(error)
    except MemoryError:
        return "failed", "the boundary elements of this design need more memory"
    except Exception as error:  # a worker must outlive whatever happens in one job
        return "failed", f"the judge failed: {type(error).__name__}: {error}"


def check(kind: Any, question: dict[str, Any]) -> None:
    """Refuse a question before a process is busy with it.

    Raises
    ------
    SpecError
        One sentence.
    """
    if kind not in KINDS:
        raise SpecError("job", kind, "one of " + ", ".join(KINDS))
    if kind in ("together", "pair_flow"):
        together.group_of(question)
    else:
        swimmer_of(question.get("tables"))
    if question.get("level", "coarse") not in LEVELS:
        raise SpecError("level", question["level"], "coarse, standard or fine")
