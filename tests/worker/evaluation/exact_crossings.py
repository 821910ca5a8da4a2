"""Which triangles pass through each other, in exact arithmetic and one pair at a time.

For meshes whose coordinates are whole numbers.
"""

from fractions import Fraction
from itertools import combinations, product

from worker.surface_mesh import SurfaceMesh

Vector = list  # of three whole numbers or fractions


def exact_self_intersections(mesh: SurfaceMesh) -> list[list[int]]:
    triangles = _whole(mesh)
    pairs = combinations(range(len(triangles)), 2)
    return [[i, j] for i, j in pairs if pass_through(triangles[i], triangles[j])]


def exact_crossings(one: SurfaceMesh, other: SurfaceMesh) -> list[list[int]]:
    first, second = _whole(one), _whole(other)
    pairs = product(range(len(first)), range(len(second)))
    return [[i, j] for i, j in pairs if pass_through(first[i], second[j])]


def pass_through(one: list[Vector], other: list[Vector]) -> bool:
    """Whether what the second triangle's plane cuts out of the first, a segment, keeps some length
    inside each of the second's edges.
    """
    foot = other[0]
    normal = _cross(_minus(other[1], foot), _minus(other[2], foot))
    heights = [_dot(normal, _minus(corner, foot)) for corner in one]
    if not min(heights) < 0 < max(heights):
        return False
    ends = [corner for corner, height in zip(one, heights, strict=True) if height == 0]
    for (p, above), (q, below) in combinations(zip(one, heights, strict=True), 2):
        if above * below < 0:
            part = Fraction(above, above - below)
            ends.append([a + (b - a) * part for a, b in zip(p, q, strict=True)])
    start, end = ends
    if start == end:
        return False
    low, high = Fraction(0), Fraction(1)
    for k in range(3):
        inward = _cross(normal, _minus(other[(k + 1) % 3], other[k]))
        at_start, at_end = (_dot(inward, _minus(point, other[k])) for point in (start, end))
        if at_start <= 0 and at_end <= 0:
            return False
        if at_start < 0:
            low = max(low, Fraction(at_start) / (at_start - at_end))
        if at_end < 0:
            high = min(high, Fraction(at_start) / (at_start - at_end))
    return low < high


def _whole(mesh: SurfaceMesh) -> list[list[Vector]]:
    triangles = mesh.triangles_mm.astype(int)
    assert (triangles == mesh.triangles_mm).all()
    return triangles.tolist()


def _dot(u: Vector, v: Vector):
    return sum(a * b for a, b in zip(u, v, strict=True))


def _minus(u: Vector, v: Vector) -> Vector:
    return [a - b for a, b in zip(u, v, strict=True)]


def _cross(u: Vector, v: Vector) -> Vector:
    return [u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2] for k in range(3)]
