"""Isotropic remeshing: even triangles of a chosen edge length, fit for finite elements."""

import math
from collections.abc import Callable

import numpy as np

from schemas.problem import InternalError, ProblemType
from worker.arrays import SomeFaces, SomePoints
from worker.observer import Cancelled, Observer
from worker.remeshing.decimation import decimate
from worker.remeshing.edge_collapses import collapse_edges
from worker.remeshing.edge_flips import flip_edges, narrowest_cosine
from worker.remeshing.edge_splits import split_edges
from worker.remeshing.edges import edges_of
from worker.remeshing.relaxation import relax

_SAG = 0.05
"""Distance of an edge's middle from the surface, in target edges, beyond which it is divided."""

_SHORTEST_DIVIDED, _LONGEST_WHOLE = 0.7, 1.6
"""In target edges: shorter edges are not divided whatever their sag, longer ones always."""

_SHORTEST = 0.3
"""In target edges: shorter edges are collapsed where that is possible."""

_RELAXATIONS = 10
_MOST_RELAXATIONS = 20
"""So many while triangles under 20 degrees are left, whose shortest edges then are collapsed."""

_NARROW = math.cos(math.radians(21.0))

OntoSurface = Callable[[SomePoints], SomePoints]
"""Points (n, 3) beside the surface to points of it, or nearer to it: one Newton step will do."""


def remesh(
    vertices: SomePoints,
    faces: SomeFaces,
    edge: float,
    onto_surface: OntoSurface,
    observer: Observer,
) -> tuple[SomePoints, SomeFaces]:
    """Vertices and faces of a closed mesh with edges of about `edge`, on the surface.

    Edges are shorter where the surface bends within one of them, down to about half. Vertices and
    `edge` are in the callable's length unit. Shortest edges are collapsed (libigl), in the six
    dimensions of position and normal; then, in the manner of Botsch and Kobbelt 2004, edges that
    sag are divided, edges are flipped, and vertices slide along the surface and are drawn back onto
    it. Every step keeps the mesh closed and its Euler number.

    Raises InternalError for a mesh that is not closed, Cancelled when the observer asks to stop.
    """
    try:
        edges_of(faces, len(vertices))
    except ValueError as error:
        raise InternalError(
            ProblemType.NO_SURFACE,
            f"A surface cannot be remeshed ({error}); choose another `mesh.grid_mm`, or leave "
            "`target_edge_mm` out.",
        ) from error

    def flipped(points: SomePoints, triangles: SomeFaces, rounds: int) -> SomeFaces:
        for _ in range(rounds):
            _look(observer)
            triangles = flip_edges(points, triangles)
        return triangles

    vertices, faces = decimate(vertices, faces, edge, observer)
    vertices = onto_surface(vertices)
    faces = flipped(vertices, faces, 3)
    vertices, faces = _sagging_split(vertices, faces, edge, onto_surface)
    vertices = onto_surface(vertices)
    faces = flipped(vertices, faces, 3)
    for step in range(_MOST_RELAXATIONS):
        narrow = _narrow(vertices, faces) & (step >= _RELAXATIONS)
        if step >= _RELAXATIONS and not narrow.any():
            break
        _look(observer)
        vertices, faces = _short_collapsed(vertices, faces, edge, narrow)
        _look(observer)
        vertices = relax(vertices, faces)
        if step % 2:
            vertices = onto_surface(vertices)
        faces = flipped(vertices, faces, 1)
    for _ in range(2):
        vertices = onto_surface(vertices)
    return vertices, flipped(vertices, faces, 1)


def _sagging_split(
    vertices: SomePoints, faces: SomeFaces, edge: float, onto_surface: OntoSurface
) -> tuple[SomePoints, SomeFaces]:
    edges = edges_of(faces, len(vertices))
    lengths = edges.lengths(vertices)
    chosen = lengths > _LONGEST_WHOLE * edge
    asked = np.flatnonzero(~chosen & (lengths > _SHORTEST_DIVIDED * edge))
    middles = 0.5 * (vertices[edges.start[asked]] + vertices[edges.end[asked]])
    sags = np.linalg.norm(onto_surface(middles) - middles, axis=1)
    chosen[asked] = sags > _SAG * edge
    return split_edges(vertices, faces, edges, chosen)


def _narrow(vertices: SomePoints, faces: SomeFaces) -> np.ndarray:
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return narrowest_cosine(a, b, c) > _NARROW


def _short_collapsed(
    vertices: SomePoints, faces: SomeFaces, edge: float, narrow: np.ndarray
) -> tuple[SomePoints, SomeFaces]:
    """Without edges that are short, or the shortest of a `narrow` face, (m,) flags."""
    edges = edges_of(faces, len(vertices))
    lengths = edges.lengths(vertices)
    of_half_edge = np.empty(3 * len(faces))
    of_half_edge[edges.here] = of_half_edge[edges.there] = lengths
    shortest = 3 * np.arange(len(faces)) + np.argmin(of_half_edge.reshape(-1, 3), axis=1)
    of_narrow = np.zeros(3 * len(faces), dtype=bool)
    of_narrow[shortest[narrow]] = True
    short = (lengths < _SHORTEST * edge) | of_narrow[edges.here] | of_narrow[edges.there]
    return collapse_edges(vertices, faces, short) if short.any() else (vertices, faces)


def _look(observer: Observer) -> None:
    if observer.is_cancelled():
        raise Cancelled
