from collections import Counter

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from worker.evaluation.mesh_edges import mesh_edges
from worker.surface_mesh import SurfaceMesh

meshes = st.integers(0, 12).flatmap(
    lambda count: st.builds(
        SurfaceMesh,
        st.just(np.zeros((9, 3))),
        arrays(np.int64, (count, 3), elements=st.integers(0, 8)),
    )
)


@settings(deadline=None)
@given(meshes)
def test_every_side_is_counted_with_its_edge(mesh):
    """Against one side at a time."""
    sides = [(int(f[k]), int(f[(k + 1) % 3])) for f in mesh.faces for k in range(3)]
    times = Counter((min(side), max(side)) for side in sides)
    forward = Counter(side for side in sides if side[0] <= side[1])
    edges = mesh_edges(mesh)
    ends = [tuple(pair) for pair in edges.ends.tolist()]
    assert ends == sorted(times)
    assert edges.times.tolist() == [times[pair] for pair in ends]
    assert edges.forward.tolist() == [forward[pair] for pair in ends]
    told = np.repeat(edges.ends, edges.times, axis=0).tolist()
    assert [sorted(sides[side]) for side in edges.sides] == told
