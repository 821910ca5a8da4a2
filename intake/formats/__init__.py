"""Files of other programs, read as contour studies: bytes in, a study and its warnings out."""
