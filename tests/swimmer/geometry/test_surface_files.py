"""Bodies from surface files: what is read, mended and said, refused with place and mend."""

import numpy as np
import pytest

import microswim as ms
from microswim.swimmer.geometry.solids.coarsening import coarsened
from microswim.swimmer.geometry.solids.crossing import winding
from microswim.swimmer.geometry.solids.paired import facets_of
from microswim.swimmer.geometry.solids.reading import checked, read
from microswim.swimmer.geometry.solids.triangles import Triangles

trimesh = pytest.importorskip("trimesh")

BALL = trimesh.creation.icosphere(2)
BOX = trimesh.creation.box((2.0, 1.0, 0.6))


def triangles(mesh):
    return np.array(mesh.vertices, float), np.array(mesh.faces, np.int64)


@pytest.mark.parametrize("ending", ["stl", "ply", "obj"])
def test_formats_give_the_same_surface(tmp_path, ending):
    file = tmp_path / f"ball.{ending}"
    BALL.export(file)
    found = read(file)
    assert found.remarks == ()
    assert len(found.surface.faces) == len(BALL.faces)
    assert found.surface.volume == pytest.approx(BALL.volume, rel=1e-5)


def test_a_text_stl_is_read(tmp_path):
    BOX.export(tmp_path / "box.stl", file_type="stl_ascii")
    assert read(tmp_path / "box.stl").surface.volume == pytest.approx(1.2, rel=1e-6)


def test_harmless_faults_are_mended_and_said():
    points, faces = triangles(BOX)
    turned = faces.copy()
    turned[:3] = turned[:3, ::-1]
    twice = np.concatenate([faces, faces[:1], [[0, 0, 1]]])
    for wrong, word in ((turned, "turned"), (faces[:, ::-1], "inwards"), (twice, "left out")):
        found = checked(points, wrong)
        assert found.surface.volume == pytest.approx(1.2)
        assert any(word in remark for remark in found.remarks)


def test_a_hollow_is_left_out_and_two_bodies_are_both_kept():
    points, faces = triangles(BALL)
    count = len(points)
    within = checked(np.concatenate([points, 0.5 * points]), np.concatenate([faces, faces + count]))
    assert within.surface.volume == pytest.approx(BALL.volume)
    assert "hollow" in within.remarks[0]
    beside = checked(
        np.concatenate([points, points + [3, 0, 0]]),
        np.concatenate([faces, faces[:, ::-1] + count]),
    )
    assert beside.surface.volume == pytest.approx(2 * BALL.volume)


def test_faults_are_refused_with_place_and_mend():
    points, faces = triangles(BALL)
    count = len(points)
    fin = np.concatenate([points, [[0.0, 0.0, 3.0]]])
    edge = np.concatenate([faces, [[faces[0, 0], faces[0, 1], count]]])
    crossing = np.concatenate([points, points + [0.9, 0.1, 0.2]])
    mirrored = np.concatenate([points - [0.7, 0, 0], points * [-1, 1, 1] + [0.7, 0, 0]])
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    for wrong, words in (
        ((points, faces[1:]), ("hole at (", "close it")),
        ((fin, edge), ("at (", "close it")),
        ((crossing, np.concatenate([faces, faces + count])), ("through itself at (", "unite")),
        ((mirrored, np.concatenate([faces, faces[:, ::-1] + count])), ("through itself", "unite")),
        ((flat, np.array([[0, 1, 2], [0, 2, 1]])), ("holds no surface", "export")),
        ((points * np.nan, faces), ("no numbers", "export")),
        ((points, faces + 5), ("does not hold", "export")),
    ):
        with pytest.raises(ms.SpecError) as told:
            checked(*wrong)
        assert all(word in str(told.value) for word in words), str(told.value)
        assert "\n" not in str(told.value)


def test_an_edge_of_four_triangles_is_refused():
    points, faces = triangles(trimesh.creation.box((1, 1, 1)))
    other = points + [1.0, 1.0, 0.0]  # two cubes that share an edge
    with pytest.raises(ms.SpecError, match="more than two triangles"):
        checked(np.concatenate([points, other]), np.concatenate([faces, faces + len(points)]))


def test_the_winding_number_counts_in_and_out():
    points, faces = triangles(BALL)
    assert winding(np.array([0.1, 0.2, 0.3]), points, faces) == pytest.approx(1.0)
    assert winding(np.array([1.4, 0.0, 0.3]), points, faces) == pytest.approx(0.0, abs=1e-9)


def deepest(surface: Triangles) -> float:
    """Largest distance of the curved patches from the unit sphere."""
    u = np.linspace(-1.0, 1.0, 7)
    U, V = np.meshgrid(u, u)
    return max(
        np.abs(np.linalg.norm(f.chart(U, V), axis=-1) - 1).max()
        for f in facets_of(surface, 10.0, 0)
    )


def test_curved_patches_tend_to_the_sphere_faster_than_flat_ones():
    errors = [deepest(Triangles(*triangles(trimesh.creation.icosphere(n)))) for n in (1, 2, 3)]
    assert errors[2] < 1e-3
    assert errors[0] / errors[2] > 16.0


def test_flat_faces_and_sharp_edges_stay():
    box = Triangles(*triangles(BOX))
    size = np.array([1.0, 0.5, 0.3])
    for facet in facets_of(box, 0.4, 2):
        u, v = np.meshgrid(facet.u, facet.v)
        X = np.abs(facet.chart(u, v)) / size
        assert X.max() < 1 + 1e-12
        assert np.abs(X.max(axis=-1) - 1).max() < 1e-12
    assert sum((f.u.size - 1) * (f.v.size - 1) for f in facets_of(box, 0.4, 2)) > 60


def test_coarsening_keeps_the_corners_on_the_surface():
    fine = Triangles(*triangles(trimesh.creation.icosphere(4)))
    coarse = coarsened(fine, 1000)
    assert 300 < len(coarse.faces) <= 1000
    assert np.abs(np.linalg.norm(coarse.points, axis=1) - 1).max() < 1e-6


def test_a_body_is_placed_at_the_joint_or_where_it_is_told(tmp_path):
    file = str(tmp_path / "box.stl")
    BOX.export(file)
    body = ms.SurfaceFile(file=file, scale=1e-3)
    own = body.triangles
    assert own is not None
    assert own.points[:, 0].max() == pytest.approx(0.0, abs=1e-12)
    assert body.semi_axes3 == pytest.approx((1e-3, 0.5e-3, 0.3e-3))
    turned = ms.SurfaceFile(
        file=file, scale=1e-3, rotation=(np.sqrt(0.5), 0, 0, np.sqrt(0.5)), position=(0.0, 0, 1e-3)
    )
    assert turned.semi_axes3 == pytest.approx((0.5e-3, 1e-3, 0.3e-3))
    assert turned.triangles is not None
    assert turned.triangles.points[:, 2].min() == pytest.approx(0.7e-3)


def test_fields_out_of_range_are_refused(tmp_path):
    file = str(tmp_path / "box.stl")
    BOX.export(file)
    for fields, word in (
        ({"file": "x.step"}, "STL, PLY or OBJ"),
        ({"scale": 0.0}, "body.scale"),
        ({"rotation": (2.0, 0, 0, 0)}, "of length one"),
        ({"position": (1.0, 2.0)}, "body.position"),
    ):
        with pytest.raises(ms.SpecError, match=word):
            ms.SurfaceFile(**{"file": file, "scale": 1.0, **fields})
