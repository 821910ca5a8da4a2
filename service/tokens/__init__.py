"""Bearer tokens of an OpenID Connect issuer: which are believed, and whom they stand for."""
