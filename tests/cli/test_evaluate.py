import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
import typer
from typer.testing import CliRunner

from cli.evaluate import evaluate
from schemas.problem import InputError

app = typer.Typer()
app.command()(evaluate)


def run(*arguments: object) -> str:
    result = CliRunner().invoke(app, [str(a) for a in arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


@pytest.fixture
def spheres(tmp_path) -> tuple[Path, Path]:
    paths = tmp_path / "found.stl", tmp_path / "true.ply"
    for path, radius in zip(paths, (22.0, 20.0), strict=True):
        trimesh.creation.icosphere(subdivisions=5, radius=radius).export(path)
    return paths


def test_concentric_spheres_in_json(spheres):
    found = json.loads(run(*spheres, "--json"))
    assert found["surface_distance"]["mean_mm"] == pytest.approx(2.0, abs=0.02)
    assert found["surface_distance"]["to_reference"]["max_mm"] == pytest.approx(2.0, abs=0.03)
    assert found["volume_difference_percent"] == pytest.approx(33.1, abs=0.01)
    assert found["mesh"]["watertight"]
    assert found["mesh"]["euler_number"] == 2
    assert found["point_set_distance"]["chamfer_mm2"] > 8.0


def test_a_surface_against_itself_is_at_no_distance(spheres):
    found = json.loads(run(spheres[0], spheres[0], "--json"))
    assert found["surface_distance"]["hausdorff_mm"] < 1e-9
    assert found["volume_difference_percent"] == 0.0


def test_the_table_tells_the_same(spheres):
    text = run(*spheres)
    for word in ("mesh to reference", "reference to mesh", "Chamfer mm2", "volume mL", "44."):
        assert word in text


def test_an_open_surface_is_told_open(spheres, tmp_path):
    solid = trimesh.creation.icosphere(subdivisions=3, radius=20.0)
    solid.update_faces(np.arange(len(solid.faces)) > 0)
    solid.export(tmp_path / "open.obj")
    found = json.loads(run(tmp_path / "open.obj", spheres[1], "--json"))
    assert found["mesh"]["volume_ml"] is None
    assert found["volume_difference_percent"] is None
    assert "open" in run(tmp_path / "open.obj", spheres[1])


def test_json_has_no_infinity_even_for_triangles_without_area(spheres, tmp_path):
    flat = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n"
    (tmp_path / "flat.obj").write_text(flat)
    found = json.loads(run(tmp_path / "flat.obj", spheres[1], "--json", "--samples", 100))
    assert found["mesh"]["quality"]["aspect_ratio_max"] is None


def test_a_missing_file_is_bad_input(spheres, tmp_path):
    with pytest.raises(InputError, match=r"no file.*check the path"):
        run(spheres[0], tmp_path / "nowhere.stl")


def test_curvature_is_compared_where_it_is_asked_for(spheres):
    assert json.loads(run(*spheres, "--json"))["curvature"] is None
    found = json.loads(run(*spheres, "--curvature-edge-mm", 3, "--json"))["curvature"]
    assert found["edge_mm"] == 3.0
    assert found["mean_per_mm"]["mean_abs"] == pytest.approx(1 / 20.0 - 1 / 22.0, rel=0.15)
    assert "Gaussian, 1/mm2" in run(*spheres, "--curvature-edge-mm", 3)


def test_an_open_surface_is_not_compared_in_curvature_and_says_so(spheres, tmp_path):
    solid = trimesh.creation.icosphere(subdivisions=3, radius=20.0)
    solid.update_faces(np.arange(len(solid.faces)) > 0)
    solid.export(tmp_path / "open.obj")
    said = run(tmp_path / "open.obj", spheres[1], "--curvature-edge-mm", 3)
    assert "both surfaces must be closed" in said


@pytest.fixture
def displaced(tmp_path) -> tuple[Path, Path]:
    """An ellipsoid of three half-axes, and the same turned by 5 degrees and moved by 3 mm."""
    solid = trimesh.creation.icosphere(subdivisions=4, radius=20.0)
    solid.vertices *= [1.0, 1.2, 1.5]
    solid.export(tmp_path / "true.ply")
    solid.apply_transform(trimesh.transformations.rotation_matrix(np.radians(5.0), [1, 2, 2]))
    solid.apply_translation([2.0, -2.0, 1.0])
    solid.export(tmp_path / "displaced.ply")
    return tmp_path / "displaced.ply", tmp_path / "true.ply"


def test_a_displaced_surface_is_laid_onto_its_reference_where_that_is_asked_for(displaced):
    as_it_lies = json.loads(run(*displaced, "--json"))
    assert as_it_lies["placement"] is None
    assert as_it_lies["surface_distance"]["hausdorff_mm"] > 2.0
    laid = json.loads(run(*displaced, "--align", "--json"))
    assert laid["surface_distance"]["hausdorff_mm"] < 0.01
    assert laid["placement"]["rotation_deg"] == pytest.approx(5.0, abs=0.01)
    assert laid["placement"]["translation_mm"] == pytest.approx([-2.0, 2.0, -1.0], abs=0.01)
    said = " ".join(run(*displaced, "--align").split())
    assert "turned by 5.000 degrees, its centroid moved by (-2.000, 2.000, -1.000) mm" in said


def test_a_surface_without_area_cannot_be_laid_anywhere(displaced, tmp_path):
    (tmp_path / "line.obj").write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
    with pytest.raises(InputError, match="no triangle with area"):
        run(tmp_path / "line.obj", displaced[1], "--align")


def test_directed_point_set_distances_are_given(spheres):
    found = json.loads(run(*spheres, "--json"))["point_set_distance"]
    assert found["to_reference"]["samples"] == 20_000
    assert found["hausdorff_mm"] == max(
        found[way]["max_mm"] for way in ("to_reference", "from_reference")
    )
    assert "Directed distances" in run(*spheres)
