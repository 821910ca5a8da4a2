"""Fuzzing: a real service is sent what it should never get, and every answer is judged."""
