"""The one component of a level set that the contours touch, oriented outward."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from worker.arrays import Faces, Points, SomeFaces, SomePoints


def touched_component(
    vertices: SomePoints, faces: SomeFaces, touching: SomePoints
) -> tuple[SomePoints, SomeFaces]:
    """The connected component nearest to most of the `touching` points (n, 3).

    Islands far from all evidence and bubbles inside are left behind, however large they are.
    Returns vertices that are used, and faces that refer to them.
    """
    first = np.concatenate([faces[:, 0], faces[:, 1]])
    second = np.concatenate([faces[:, 1], faces[:, 2]])
    size = len(vertices)
    graph = coo_matrix((np.ones(len(first), dtype=np.int8), (first, second)), shape=(size, size))
    count, label = connected_components(graph, directed=False)
    if count > 1:
        _, nearest = cKDTree(vertices).query(touching)
        chosen = int(np.argmax(np.bincount(label[nearest], minlength=count)))
        faces = faces[label[faces[:, 0]] == chosen]
    used, renumbered = np.unique(faces, return_inverse=True)
    return vertices[used], renumbered.reshape(faces.shape).astype(np.int64)


def outward(vertices: Points, faces: Faces) -> Faces:
    """Faces counter-clockwise seen from outside, of a closed and consistently oriented mesh."""
    a, b, c = np.moveaxis(vertices[faces] - vertices.mean(axis=0), 1, 0)
    enclosed = float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum())
    return faces if enclosed >= 0.0 else np.ascontiguousarray(faces[:, ::-1])
