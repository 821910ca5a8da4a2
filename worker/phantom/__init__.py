"""Hearts with known truth, and the slicing of any closed surface into contours."""
