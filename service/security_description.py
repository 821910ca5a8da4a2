"""What the API description says about keys and tokens: the schemes, and each operation's scope."""

from typing import Any

from service.documented import problems
from service.door import API_KEY_HEADER, scope_needed

_SCHEMES: dict[str, Any] = {
    "bearer": {
        "type": "http",
        "scheme": "bearer",
        "bearerFormat": "nmri_<id>_<secret>",
        "description": "An API key, as `neuralmri keys create` shows it once. A service without "
        "any key asks for none.",
    },
    "header": {
        "type": "apiKey",
        "in": "header",
        "name": API_KEY_HEADER,
        "description": "The same key, where a proxy needs `Authorization` for itself.",
    },
    "token": {
        "type": "http",
        "scheme": "bearer",
        "bearerFormat": "JWT",
        "description": "An access token (RFC 9068) of the OpenID Connect issuer that the operator "
        "has named, for this service's audience. A service that trusts no issuer takes none.",
    },
}


def add_security(description: dict[str, Any]) -> None:
    """Write schemes, and for every operation that is not open its scope and refusals."""
    description["components"]["securitySchemes"] = _SCHEMES
    for path, operations in description["paths"].items():
        for method, operation in operations.items():
            scope = scope_needed(method, path)
            if scope is None:
                operation["security"] = []
                continue
            operation["security"] = [{scheme: [scope.value]} for scheme in _SCHEMES]
            operation["description"] += f"\n\nScope: `{scope}`."
            refusals = {str(status): found for status, found in problems(401, 403).items()}
            operation["responses"] = dict(
                sorted({**refusals, **operation["responses"]}.items(), key=lambda item: item[0])
            )
