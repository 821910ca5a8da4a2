"""Even triangles on a given surface, fit for finite elements: mesh in, mesh out."""
