"""A swimmer as one closed surface in an STL file, read back as what it was."""

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.models.bem.levels import get_level
from microswim.models.bem.patches.mesh import swimmer_surface
from microswim.output.io.stl import write_stl

pytest.importorskip("trimesh")
pytest.importorskip("manifold3d")

FLUID = ms.Fluid(viscosity=1.0)
HELIX = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
BASE = ms.Swimmer(body=ms.Sphere(radius=0.5), tail=HELIX, fluid=FLUID)


def facets_of(path):
    """Corners (n, 3, 3) and normals (n, 3) as the file has them."""
    raw = path.read_bytes()
    rows = np.frombuffer(raw[84:], [("v", "<f4", (4, 3)), ("attributes", "<u2")])
    assert len(rows) == int(np.frombuffer(raw[80:84], "<u4")[0])
    return rows["v"][:, 1:].astype(float), rows["v"][:, 0]


def volume(corners):
    return float(np.einsum("ni,ni->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6)


@pytest.mark.parametrize(
    ("body", "tail", "fineness"),
    [
        (ms.Sphere(radius=0.5), HELIX, 1.0),
        (ms.NoBody(), HELIX, 2.0),
        (ms.Cylinder(length=1.5, radius=0.5), HELIX, 1.0),
        (ms.Box(size=(1.0, 0.8, 0.6)), ms.NoTail(), 1.0),
    ],
)
def test_it_is_closed_faces_outwards_and_holds_the_swimmers_volume(body, tail, fineness, tmp_path):
    swimmer = ms.Swimmer(body=body, tail=tail, fluid=FLUID)
    corners, normals = facets_of(write_stl(tmp_path / "it.stl", swimmer, fineness=fineness))
    edges = {}
    for face in [[tuple(p) for p in f] for f in corners.tolist()]:
        for a, b in zip(face, face[1:] + face[:1]):
            edges[a, b] = edges.get((a, b), 0) + 1
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.sum(across * normals, axis=1) > 0).all()
    patches = swimmer_surface(body, tail, 0.0, get_level("coarse").resolution)
    assert volume(corners) == pytest.approx(patches.extent[1], rel=0.012)  # chords lie within arcs


def test_a_swimmer_in_si_is_written_in_millimetres(tmp_path):
    small = ms.Swimmer.preset("goto/C")
    path = write_stl(tmp_path / "it.stl", small)
    corners, _ = facets_of(path)
    assert b"one unit is 1 mm" in path.read_bytes()[:80]
    size = 2.0 * small.body.semi_axes3[0] + small.tail.apparent_length + small.tail.radius
    assert np.ptp(corners[..., 0]) == pytest.approx(1e3 * size, rel=0.02)


def test_the_command_says_the_unit_and_overwrites_nothing(tmp_path):
    path = tmp_path / "it.stl"
    args = ["show", "--preset", "tabak/helix", "--stl", str(path)]
    done = CliRunner().invoke(main, args)
    assert done.exit_code == 0, done.output
    assert "one unit is 1:" in done.stderr
    again = CliRunner().invoke(main, args)
    assert again.exit_code == 2
    assert "--force" in again.output
    assert CliRunner().invoke(main, [*args, "--force"]).exit_code == 0


@pytest.mark.slow
def test_the_base_case_is_read_back_as_it_was(tmp_path):
    """Half a per cent of the structured solve, in units of sqrt(R_ii R_jj)."""
    known = ms.mobility(BASE)
    found = ms.mobility(write_stl(tmp_path / "it.stl", BASE), scale=1.0)
    x, y, z = known.about - found.about
    moved = np.eye(6)
    moved[:3, 3:] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    R = moved.T @ found.resistance @ moved
    root = np.sqrt(known.resistance.diagonal())
    assert np.abs((R - known.resistance) / np.outer(root, root)).max() < 5e-3
