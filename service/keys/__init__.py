"""API keys: made, kept, and asked for."""
