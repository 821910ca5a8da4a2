"""The classical methods: every surface for itself."""

from collections.abc import Callable
from functools import partial

from benchmarks.found import Found
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.interpolation.hermite_rbf import hermite_rbf
from worker.interpolation.lofting import lofted
from worker.interpolation.shape_based import Blend, shape_based
from worker.reconstruction.slice_stack import SliceStack
from worker.reconstruction.stacking import build_stack
from worker.surface_mesh import SurfaceMesh

Interpolate = Callable[[SliceStack, Structure], SurfaceMesh]


def each_surface(study: ContourStudy, interpolate: Interpolate) -> Found:
    """Every observed surface of the first frame; one that fails says why."""
    stack = build_stack(study, study.frames[0])
    surfaces, failures = {}, {}
    for structure in sorted(stack.observed):
        try:
            surfaces[structure] = interpolate(stack, structure)
        except Exception as error:  # noqa: BLE001  kept as this surface's row; others still count
            failures[structure] = f"{type(error).__name__}: {error}"
    return Found(surfaces, failures=failures)


by_shape_linear = partial(each_surface, interpolate=partial(shape_based, blend=Blend.LINEAR))
by_shape_cubic = partial(each_surface, interpolate=partial(shape_based, blend=Blend.CUBIC))
by_lofting = partial(each_surface, interpolate=lofted)
by_hermite_rbf = partial(
    each_surface,
    interpolate=partial(hermite_rbf, solves=1, off_surface_mm=1.0, smoothing=0.0),
)
by_hermite_rbf_refined = partial(each_surface, interpolate=hermite_rbf)
