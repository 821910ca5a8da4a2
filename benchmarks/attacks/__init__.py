"""Attacks on a running service: what is tried, what must come back, what does."""
