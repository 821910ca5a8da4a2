"""One file a format: how each writes a surface, and where it keeps what is known of it."""
