"""The direction from apex to base along which errors are told by region."""

from collections.abc import Mapping

import numpy as np

from schemas.vocabulary import Structure, View
from worker.arrays import Vector
from worker.phantom.long_axis import long_axis
from worker.reconstruction.slice_stack import SliceStack
from worker.surface_mesh import SurfaceMesh


def apex_to_base(stack: SliceStack, truth: Mapping[Structure, SurfaceMesh]) -> Vector:
    """The unit normal (3,) of a stack's short-axis slices, turned from apex to base.

    The base is the end where the true LV is blunter. Without short-axis slices: the LV's own axis.
    """
    own = long_axis(truth).towards_base
    normals = [s.normal * np.sign(s.normal @ own) for s in stack.slices if s.view is View.SAX]
    mean = np.mean(normals, axis=0) if normals else own
    return mean / np.linalg.norm(mean)
