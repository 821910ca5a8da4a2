"""The addresses of the API, one file an idea."""
