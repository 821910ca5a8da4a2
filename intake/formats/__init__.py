"""Contour files of other programs, read into a contour study: bytes in, study and warnings out."""
