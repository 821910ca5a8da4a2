"""VTK PolyData: point data arrays for the numbers at the vertices, field data for the rest."""

from pathlib import Path

from worker.artifacts.mesh_files.content import Content


def write_vtp(path: Path, content: Content) -> None:
    """Points in mm; every field a point data array under its own name, explained in `fields`."""
    # Here, since VTK takes half a second to load, and no other format needs it.
    import pyvista

    mesh = content.mesh
    surface = pyvista.PolyData.from_regular_faces(mesh.vertices_mm, mesh.faces)
    for key, value in content.facts().items():
        surface.field_data[key] = [value]
    if content.fields:
        surface.field_data["fields"] = [one.described for one in content.fields]
    for one in content.fields:
        surface.point_data[one.name] = one.values
    surface.save(path)
