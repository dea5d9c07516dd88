"""Sizes of the patches of a swimmer's surface."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Sides:
    """Sizes of the patches of a tube around a swimmer.

    Parameters
    ----------
    around : int
        Patches around the tube times the order of the density.
    along : float
        Longest patch, in radii of the tube.
    change : float
        Most that the distance to the swimmer may change over a patch, in units of the smallest.
    """

    around: int = 24
    along: float = 0.8
    change: float = 2.0


@dataclass(frozen=True)
class Resolution:
    """Sizes of patches.

    Parameters
    ----------
    order : int
        p, density nodes a side of a patch.
    panel : float
        Shortest usual length of a tube panel, in filament radii.
    stretch : float
        Longest, where the tail is straight, in filament radii.
    bend : float
        Panel length times curvature, between those two.
    wave : float
        Longest panel by the phase of the wave along it (rad).
    slender : float
        Panels of slender filaments may be longer than `stretch`: to this much of the radius of
        curvature and of the wave's phase (rad), and
    reach : float
        in filament radii.
    around : int
        Panels around the tube.
    root : float
        Length of the first panel and of the first ring at the joint, in filament radii.
    growth : float
        Ratio of successive lengths away from the joint.
    body : int
        Patches along a quarter of the body's circumference; one more on elongated bodies.
    alone : int
        The same of a body without a tail.
    file : str
        Level of the patches through the triangles of a body without a tail.
    vessel : `Sides`
        Sizes of the patches of a tube around the swimmer.
    """

    order: int = 2
    panel: float = 2.5
    stretch: float = 5.0
    bend: float = 0.4
    wave: float = 1.2
    slender: float = 0.0
    reach: float = 24.0
    around: int = 4
    root: float = 0.7
    growth: float = 2.0
    body: int = 2
    alone: int = 2
    file: str = "standard"
    vessel: Sides = Sides()
