"""ITK's morphological interpolation, apart: no other method should carry ITK's memory."""

from functools import partial

from benchmarks.by_interpolation import each_surface
from benchmarks.morphological import morphological

by_morphological = partial(each_surface, interpolate=morphological)
