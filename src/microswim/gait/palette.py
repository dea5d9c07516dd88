"""Colours that page, figures and films share: of a swimmer, its path, and of a map's values.

Plain texts, so that nothing is imported for them. The map is matplotlib's viridis at even steps.
"""

from __future__ import annotations

BODY, TAIL, PATH = "#e3d5b8", "#3db7ac", "#f2b661"
#: The same of a second swimmer beside the first.
SECOND = ("#cfd9ee", "#8f8bea", "#a9b4ff")
MAP = (
    "#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30",
    "#fde725",
)  # fmt: skip
EDGE = MAP[0]  #: of fluid at rest
