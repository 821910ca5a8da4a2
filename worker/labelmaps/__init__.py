"""NIfTI label maps in, contour study out."""
