"""The studio: a page in the browser where a swimmer swims while its numbers are dragged.

The browser animates by itself from a gait's few Fourier coefficients; the server answers when a
number changes and keeps nothing about anyone.
"""

from __future__ import annotations

from typing import Any

__all__ = ["serve", "snapshot"]


def serve(tables: dict[str, Any], name: str, **options: Any) -> None:
    """Serve the page until interrupted; see `microswim.studio.server.serve`."""
    from microswim.studio.brought.surfaces import admitted
    from microswim.studio.server import serve as run

    run(admitted(tables), name, **options)


def snapshot(tables: dict[str, Any], name: str) -> str:
    """Return the page as one HTML file that plays without a server, with a map of amplitude and
    waves.
    """
    from microswim.studio.brought.surfaces import admitted
    from microswim.studio.page import snapshot as make
    from microswim.studio.page import usual_map

    tables = admitted(tables)
    return make([{"name": name, "tables": tables}], usual_map(tables))
