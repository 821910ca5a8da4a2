from pathlib import Path
from xml.etree import ElementTree

import pyvista

from worker.artifacts.mesh_files.pvd import write_pvd
from worker.artifacts.mesh_files.vtp import write_vtp

PARTS = [(0.0, "A_lv_endo.vtp"), (33.333333, "B--_lv_endo.vtp"), (1200.5, "C_lv_endo.vtp")]


def test_paraview_s_reader_finds_every_file_at_its_time(content, tmp_path: Path) -> None:
    for _, name in PARTS:
        write_vtp(tmp_path / name, content)
    write_pvd(tmp_path / "lv_endo.pvd", PARTS, "ms", {})
    reader = pyvista.get_reader(str(tmp_path / "lv_endo.pvd"))
    assert reader.time_values == [time for time, _ in PARTS]
    for place in range(len(PARTS)):
        reader.set_active_time_point(place)
        assert reader.read()[0].n_points == len(content.mesh.vertices_mm)


def test_it_is_a_collection_that_says_in_what_its_times_are(tmp_path: Path) -> None:
    path = tmp_path / "lv_endo.pvd"
    write_pvd(path, PARTS, "frame index", {"axes": "LPS", "name": "lv_endo"})
    root = ElementTree.fromstring(path.read_text(encoding="ascii"))  # noqa: S314  our own
    assert (root.tag, root.get("type")) == ("VTKFile", "Collection")
    sets = root.findall("./Collection/DataSet")
    assert [one.get("file") for one in sets] == [name for _, name in PARTS]
    assert {one.get("part") for one in sets} == {"0"}
    said = "<!-- neuralmri axes=LPS name=lv_endo timestep_unit=frame index -->"
    assert path.read_text(encoding="ascii").splitlines()[1] == said
