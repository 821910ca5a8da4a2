"""Meshes in, numbers out."""
