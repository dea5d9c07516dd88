"""How a swimmer is shown to people: as text, as a picture, as a page to turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from microswim.gait import doors, portrait
from microswim.swimmer.in_units import as_units

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from microswim.studio.view import View


class Shown:
    """What is printed and drawn of a swimmer."""

    def __str__(self) -> str:
        """Return a line for each part, with units."""
        return portrait.as_text(*doors.go(doors.PORTRAIT, self))

    def _repr_html_(self) -> str:
        return portrait.as_html(*doors.go(doors.PORTRAIT, self))

    def plot(self) -> Figure:
        """Draw the swimmer to scale with its path by the surrogate; call its ``savefig``.

        Examples
        --------
        >>> import microswim as ms
        >>> ms.Swimmer.preset("tabak/helix-constant").plot().axes[1].get_xlabel()
        'sideways'
        """
        return doors.go(doors.PLOT_SWIMMER, self)

    def view(self) -> View:
        """Show the swimmer from all sides as it swims: the page of the studio, with it inside.

        A notebook shows it by itself; elsewhere call its ``show()``, or ``save("robot.html")``.

        Raises
        ------
        SpecError
            If the tail is given by a function, which the page does not run.

        Examples
        --------
        >>> import microswim as ms
        >>> view = ms.Swimmer.preset("tabak/helix").view()
        >>> view.html[:15]
        '<!doctype html>'
        """
        with as_units(self):
            return doors.go(doors.VIEW, self)
