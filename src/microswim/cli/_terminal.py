"""The terminal as it is: narrow, without Unicode, closed, or a full disk."""

from __future__ import annotations

import codecs
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from microswim.numerics.compiling.first_time import tell_once

#: What stands for a character that the output cannot show.
PLAIN = {"µ": "u", "±": "+-", "²": "^2", "³": "^3", "·": " ", "×": "x", "°": " deg", "γ": "gamma"}
PLAIN |= {"–": "-", "—": "-", "…": "...", "→": "->", "≤": "<=", "≥": ">=", "Ω": "Omega"}


def _plain(error: UnicodeError) -> tuple[str, int]:
    assert isinstance(error, UnicodeEncodeError)
    lost = error.object[error.start : error.end]
    return "".join(PLAIN.get(c, "?") for c in lost), error.end


codecs.register_error("microswim.plain", _plain)


@contextmanager
def prepared() -> Iterator[None]:
    """Print anything anywhere within; a disk that is full or an output that fails is a sentence.

    Raises
    ------
    SystemExit
        With status 1 if what was printed could not be written.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="microswim.plain")
    os.environ["MPLBACKEND"] = "agg"  # pictures go to files; a display may not be there
    if sys.stderr.isatty():
        tell_once(_compiling)
    said = False
    try:
        yield
    except OSError as error:
        _give_up(error, said)
    except SystemExit as end:
        said = bool(end.code)
        raise
    finally:
        try:
            sys.stdout.flush()
        except OSError as error:
            _give_up(error, said)


def _compiling() -> None:
    print("compiling for the first time; the code is kept", file=sys.stderr)


def _give_up(error: OSError, said: bool) -> None:
    """Say why nothing can be printed, unless an error was said already; end with status 1."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, sys.stdout.fileno())  # the interpreter flushes once more on its way out
    if not said and not isinstance(error, BrokenPipeError):
        print(f"Error: the output cannot be written: {error.strerror or error}", file=sys.stderr)
    raise SystemExit(1) from None
