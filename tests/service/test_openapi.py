import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from openapi_spec_validator import validate

from intake.contour_request import read_contour_request
from schemas.problem import Problem
from service.examples import CONTOUR_REQUEST
from service.openapi import openapi_yaml

COMMITTED = Path(__file__).parents[2] / "openapi.yaml"


@pytest.fixture(scope="module")
def description() -> dict[str, Any]:
    described: dict[str, Any] = yaml.safe_load(COMMITTED.read_text(encoding="utf-8"))
    return described


def test_the_committed_description_is_what_the_code_says() -> None:
    assert COMMITTED.read_text(encoding="utf-8") == openapi_yaml(), (
        "run `python -m service.openapi > openapi.yaml`"
    )


def test_it_is_valid_openapi(description: dict[str, Any]) -> None:
    validate(description)


def test_every_operation_documents_its_problems(description: dict[str, Any]) -> None:
    for path, operations in description["paths"].items():
        for method, operation in operations.items():
            for status, response in operation["responses"].items():
                if status == "default" or int(status) >= 400:
                    content = response["content"]["application/problem+json"]
                    assert content["schema"] == {"$ref": "#/components/schemas/Problem"}
                    Problem.model_validate(content["example"])
            assert "default" in operation["responses"], (method, path)


def test_the_example_is_a_study_that_the_door_takes() -> None:
    request, _ = read_contour_request(json.dumps(CONTOUR_REQUEST).encode())
    assert request.study.subject_id == "case-01"


def test_the_service_loads_no_science() -> None:
    """A fresh interpreter: nothing heavy comes in by a side door."""
    program = (
        "import sys, service.app, service.openapi\n"
        "heavy = {'torch', 'scipy', 'skimage', 'trimesh', 'nibabel', 'igl', 'worker'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], check=True, capture_output=True, text=True
    )
    assert ended.stdout.strip() == "[]"


def test_operations_have_names_of_their_own(description: dict[str, Any]) -> None:
    names = [o["operationId"] for path in description["paths"].values() for o in path.values()]
    assert len(set(names)) == len(names)
    assert "submit_contours" in names


def test_links_lead_to_operations_and_fill_their_paths(description: dict[str, Any]) -> None:
    parameters = {
        operation["operationId"]: {
            p["name"] for p in operation.get("parameters", []) if p["in"] == "path"
        }
        for path in description["paths"].values()
        for operation in path.values()
    }
    links = [
        link
        for path in description["paths"].values()
        for operation in path.values()
        for answer in operation["responses"].values()
        for link in answer.get("links", {}).values()
    ]
    assert {link["operationId"] for link in links} >= {"get_artifact", "replay_webhook_delivery"}
    for link in links:
        assert set(link["parameters"]) == parameters[link["operationId"]]
