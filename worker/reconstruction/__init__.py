"""The science: a contour study in, surfaces out. No queue, no clock, no environment."""
