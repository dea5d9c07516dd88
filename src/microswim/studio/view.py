"""A swimmer to look at from all sides: the page of one design, in a browser or in a notebook."""

from __future__ import annotations

import tempfile
import webbrowser
from html import escape
from os import PathLike
from pathlib import Path

from microswim import checks
from microswim.numerics.files import write
from microswim.spec.describe import to_tables
from microswim.studio import snapshot
from microswim.swimmer.swimmer import Swimmer

HEIGHT = 560  #: pixels, in a notebook


class View:
    """A page with a swimmer in it that swims, turns under the mouse, and asks no server.

    A notebook shows it by itself.

    Parameters
    ----------
    html
        The page.
    """

    def __init__(self, html: str) -> None:
        self.html = html

    @checks.given(path=checks.place)
    def save(self, path: str | PathLike[str]) -> Path:
        """Write the page; anyone can open it, without microswim.

        Examples
        --------
        >>> import tempfile, microswim as ms
        >>> view = ms.Swimmer.preset("tabak/helix").view()
        >>> file = view.save(tempfile.mkdtemp() + "/helix.html")
        >>> file.read_text()[:15]
        '<!doctype html>'
        """
        write(Path(path), self.html)
        return Path(path)

    def show(self) -> None:
        """Show the page in the browser."""
        folder = Path(tempfile.mkdtemp(prefix="microswim-"))
        webbrowser.open(self.save(folder / "swimmer.html").as_uri())

    def _repr_html_(self) -> str:
        inside = escape(self.html, quote=True)
        return (
            f'<iframe srcdoc="{inside}" width="100%" height="{HEIGHT}" style="border:0"></iframe>'
        )


def of_swimmer(swimmer: Swimmer) -> View:
    """Return the view of a swimmer, by the atlas or the surrogate as the studio has it.

    Raises
    ------
    SpecError
        If the studio does not show it: a tail by a function of Python, for one.
    """
    return View(snapshot(to_tables(swimmer), swimmer.tail.kind))
