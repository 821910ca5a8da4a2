"""Classical interpolation of surfaces between slices: what the neural field is measured against.

Every method is a function `(stack: SliceStack, structure: Structure) -> SurfaceMesh`, mm in and mm
out, with keyword options whose defaults are the best that were found for it on real hearts.
"""
