"""The description names the very scopes that the door asks for."""

from typing import Any

import pytest
import yaml

from schemas.api_key import Scope
from service.door import OPEN_PATHS
from tests.service.test_openapi import COMMITTED

PATHS: dict[str, Any] = yaml.safe_load(COMMITTED.read_text())["paths"]
OPERATIONS = [(path, method) for path, of_path in PATHS.items() for method in of_path]


@pytest.mark.parametrize(("path", "method"), OPERATIONS)
def test_every_operation_names_its_scope(path: str, method: str) -> None:
    operation = PATHS[path][method]
    if path in OPEN_PATHS:
        assert operation["security"] == []
        assert not {"401", "403"} & set(operation["responses"])
        return
    scope = Scope.READ if method == "get" else Scope.SUBMIT
    assert operation["security"] == [
        *({"bearer": [scope]}, {"header": [scope]}, {"token": [scope]})
    ]
    assert f"Scope: `{scope}`." in operation["description"]
    for status in ("401", "403"):
        assert "WWW-Authenticate" in operation["responses"][status]["headers"]


def test_the_schemes_are_keys_in_two_headers_and_tokens() -> None:
    schemes = yaml.safe_load(COMMITTED.read_text())["components"]["securitySchemes"]
    assert schemes["bearer"]["scheme"] == schemes["token"]["scheme"] == "bearer"
    assert schemes["token"]["bearerFormat"] == "JWT"
    assert (schemes["header"]["in"], schemes["header"]["name"]) == ("header", "X-API-Key")
