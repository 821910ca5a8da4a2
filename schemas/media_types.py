"""What the files of a job's results are, as HTTP says it."""

from schemas.vocabulary import MeshFormat

MESH_MEDIA_TYPES = {
    MeshFormat.STL: "model/stl",
    MeshFormat.OBJ: "model/obj",
    MeshFormat.PLY: "application/ply",
    MeshFormat.VTP: "application/vnd.vtk.polydata+xml",
    MeshFormat.GLB: "model/gltf-binary",
}

ARTIFACT_MEDIA_TYPES = {f".{form}": type_ for form, type_ in MESH_MEDIA_TYPES.items()} | {
    ".json": "application/json",
    ".pvd": "application/xml",
    ".html": "text/html; charset=utf-8",
}
"""By the end of the file's name."""
