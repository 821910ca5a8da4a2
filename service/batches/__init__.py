"""Batches: many jobs under one parent."""
