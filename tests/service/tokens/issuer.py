"""An OpenID Connect issuer on loopback, with real keys, that can be made to fail."""

import base64
import hashlib
import hmac
import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import jwt
from cryptography.hazmat.primitives import serialization
from cryptography.hazmat.primitives.asymmetric import ec, rsa
from jwt.algorithms import ECAlgorithm, RSAAlgorithm

AUDIENCE = "https://neuralmri.test"

_RSA = [rsa.generate_private_key(public_exponent=65537, key_size=2048) for _ in range(2)]
_EC = ec.generate_private_key(ec.SECP256R1())


class Issuer:
    """Signs tokens and publishes keys. `asked` counts the requests for its keys."""

    def __init__(self, port: int) -> None:
        self.url = f"http://127.0.0.1:{port}"
        self.is_down = False
        self.asked = 0
        self.described_as = self.url
        self.private: dict[str, Any] = {"first": _RSA[0], "curve": _EC}
        self.extra_keys: list[dict[str, Any]] = []

    def rotate(self) -> None:
        """Sign by a key of another name, and forget the first."""
        self.private = {"second": _RSA[1], "curve": _EC}

    def answer(self, path: str) -> tuple[int, Any]:
        if self.is_down:
            return 500, {}
        if path == "/.well-known/openid-configuration":
            return 200, {"issuer": self.described_as, "jwks_uri": f"{self.url}/keys"}
        if path != "/keys":
            return 404, {}
        self.asked += 1
        return 200, {"keys": [*self.extra_keys, *map(self._published, self.private)]}

    def _published(self, kid: str) -> dict[str, Any]:
        public = self.private[kid].public_key()
        write = RSAAlgorithm if kid != "curve" else ECAlgorithm
        return {**write.to_jwk(public, as_dict=True), "kid": kid, "use": "sig"}

    def claims(self, **other: Any) -> dict[str, Any]:
        """Of a good token; None takes a claim away."""
        claims = {
            "iss": self.url,
            "aud": AUDIENCE,
            "sub": "jane@hospital.example",
            "iat": int(time.time()),
            "exp": int(time.time()) + 600,
            "scope": "openid read submit",
            **other,
        }
        return {name: value for name, value in claims.items() if value is not None}

    def token(self, kid: str = "first", algorithm: str = "RS256", **claims: Any) -> str:
        key = self.private.get(kid) or _RSA[1]
        return jwt.encode(self.claims(**claims), key, algorithm, headers={"kid": kid})

    def unsigned(self) -> str:
        return f"{_part({'alg': 'none', 'kid': 'first'})}.{_part(self.claims())}."

    def signed_by_what_all_know(self) -> str:
        """HS256 with the public key as the secret."""
        signed = f"{_part({'alg': 'HS256', 'kid': 'first'})}.{_part(self.claims())}"
        secret = (
            self.private["first"]
            .public_key()
            .public_bytes(
                serialization.Encoding.PEM, serialization.PublicFormat.SubjectPublicKeyInfo
            )
        )
        return f"{signed}.{_base64(hmac.digest(secret, signed.encode(), hashlib.sha256))}"


@contextmanager
def issuing() -> Iterator[Issuer]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            status, document = issuer.answer(self.path)
            content = json.dumps(document).encode()
            self.send_response(status)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_: Any) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    issuer = Issuer(server.server_address[1])
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
    thread.start()
    try:
        yield issuer
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def _part(document: dict[str, Any]) -> str:
    return _base64(json.dumps(document).encode())


def _base64(raw: bytes) -> str:
    return base64.urlsafe_b64encode(raw).rstrip(b"=").decode()
