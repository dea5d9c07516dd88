"""A swimmer to look at, from Python: the page with it inside; a surface file comes along."""

import html
import json
import re
import webbrowser
from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.output.io.stl import write_stl
from microswim.studio.spec_tables import swimmer_of


def inside(page):
    """What a page that plays without a server has inside."""
    return json.loads(re.search(r'id="snapshot">(.*?)</script>', page, re.DOTALL)[1])


@pytest.mark.parametrize("name", ["goto/C", "several/two-tails", "shapes/magnet"])
def test_the_view_holds_the_swimmer_and_its_numbers(name):
    swimmer = ms.Swimmer.preset(name)
    (design,) = inside(swimmer.view().html)["designs"]
    assert swimmer_of(design["answer"]["tables"]).numbers == pytest.approx(swimmer.numbers)
    if name == "goto/C":
        found = design["answer"]["readings"]["forward_velocity"]
        assert found == pytest.approx(-swimmer.gait().mean_velocity[0], rel=1e-6)


def test_a_notebook_shows_it_and_a_browser_opens_it(monkeypatch, tmp_path):
    view = ms.Swimmer.preset("tabak/helix").view()
    frame = view._repr_html_()
    assert html.unescape(re.search(r'srcdoc="([^"]*)"', frame)[1]) == view.html
    opened = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    monkeypatch.setattr("tempfile.mkdtemp", lambda prefix: str(tmp_path))
    view.show()
    assert opened == [(tmp_path / "swimmer.html").as_uri()]
    assert (tmp_path / "swimmer.html").read_text() == view.html


def test_a_body_from_a_file_is_seen(tmp_path):
    stl, rod = tmp_path / "head.stl", ms.Swimmer.preset("shapes/rod")
    write_stl(stl, rod, fineness=0.4)
    head = ms.SurfaceFile(file=str(stl), scale=1.0)
    (design,) = inside(replace(rod, body=head).view().html)["designs"]
    assert design["answer"]["tables"]["body"]["file"].startswith("dropped/")
    assert design["answer"]["shape"]["mesh"]["faces"]


def test_a_tail_by_a_function_is_refused_in_a_sentence():
    def shape(s, phase):
        return np.stack(np.broadcast_arrays(s, 0.1 * np.cos(s - phase), 0.0), axis=-1)

    tail = ms.CustomTail(shape=shape, length=2.0, radius=0.05)
    with pytest.raises(ms.SpecError, match="runs no code"):
        replace(ms.Swimmer.preset("tabak/helix"), tail=tail).view()
