"""One mesh carried through the cycle: a surface's frames in, one topology for all of them out."""
