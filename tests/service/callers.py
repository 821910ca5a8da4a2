"""Callers with keys of their own, and what they send."""

from collections.abc import Callable
from datetime import timedelta
from pathlib import Path

from schemas.api_key import Scope
from service.examples import CONTOUR_REQUEST
from service.keys import keyring
from service.keys.key_file import KeyFile
from service.settings import ServiceSettings
from tests.service.conftest import Api

ALL = (Scope.READ, Scope.SUBMIT)
Serve = Callable[[ServiceSettings], Api]


def new_key(
    data_dir: Path, owner: str, *scopes: Scope, lifetime: timedelta | None = None
) -> tuple[str, str]:
    """Id and token of a key that is now in the key file."""
    file = KeyFile(data_dir)
    key, token = keyring.create(file, f"key of {owner}", owner, scopes or ALL, lifetime)
    return key.id, token.text


def bearer(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"}


def submit_as(api: Api, token: str) -> str:
    answer = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST, headers=bearer(token))
    assert answer.status_code == 202, answer.text
    job_id: str = answer.json()["id"]
    return job_id


def operations(api: Api) -> list[tuple[str, str]]:
    """Method and path template of everything that is not open, as the service describes itself."""
    paths = api.client.get("/openapi.json").json()["paths"]
    found = [
        (method.upper(), path)
        for path, of_path in paths.items()
        for method in of_path
        if path not in ("/healthz", "/readyz")
    ]
    assert len(found) >= 9
    return [*found, ("HEAD", "/v1/jobs/{job_id}/artifacts/{name}")]


def filled(path: str, job_id: str) -> str:
    return path.replace("{job_id}", job_id).replace("{name}", "ED_lv_endo.stl")
