"""Models that cross a wire. Pydantic and the standard library only: never an array, never I/O."""
