"""Being somebody else: other owners' jobs, keys at their end, keys that lack a scope."""

from datetime import timedelta

from benchmarks.attacks.target import Attack, Target, all_of, told
from schemas.api_key import Scope
from service.examples import CONTOUR_REQUEST
from service.keys import keyring
from service.keys.key_file import KeyFile

_KEYLESS = ("/healthz", "/readyz")


def _operations(target: Target) -> list[tuple[str, str]]:
    paths = target.ask("GET", "/openapi.json").json()["paths"]
    return [(method.upper(), path) for path, methods in paths.items() for method in methods]


def _of_the_job(target: Target) -> list[tuple[str, str]]:
    """Every operation on one job, with the victim's in the address."""
    files = {"{job_id}": target.job, "{name}": "report.json"}
    found = []
    for method, path in _operations(target):
        if "{job_id}" in path:
            for name, value in files.items():
                path = path.replace(name, value)
            found.append((method, path))
    return found


def _anothers_job(target: Target) -> str:
    return all_of(told(target.ask(*operation)) for operation in _of_the_job(target))


def _anothers_job_as_one_that_never_was(target: Target) -> str:
    never = "0" * 32
    same = [
        target.ask(method, path).json()["detail"]
        == target.ask(method, path.replace(target.job, never)).json()["detail"]
        for method, path in _of_the_job(target)
    ]
    return "the same words" if all(same) else "other words"


def _anothers_jobs_listed(target: Target) -> str:
    listed = target.ask("GET", "/v1/jobs", params={"limit": 200}).text
    cursor = target.ask("GET", "/v1/jobs", params={"cursor": "f" * 32}).text
    return "listed" if target.job in listed + cursor else "not listed"


def _anothers_idempotency_key(target: Target) -> str:
    headers = {"Idempotency-Key": "the victim's"}
    answer = target.ask("POST", "/v1/jobs/contours", json=CONTOUR_REQUEST, headers=headers)
    replayed = "idempotency-replayed" in answer.headers or answer.json()["id"] == target.job
    return f"{told(answer)}, {'the other job' if replayed else 'a job of its own'}"


def _with_key(target: Target, lifetime: timedelta | None, revoked: bool) -> str:
    file = KeyFile(target.service.settings.data_dir)
    key, token = keyring.create(file, "spent", "victim", (Scope.ADMIN,), lifetime)
    if revoked:
        keyring.revoke(file, key.id)
    headers = {"Authorization": f"Bearer {token.text}"}
    answers = (
        told(target.ask(method, path, headers=headers))
        for method, path in _operations(target)
        if path not in _KEYLESS and path != "/metrics"
    )
    return all_of(answers)


def _without_scope(target: Target, scope: Scope, methods: tuple[str, ...]) -> str:
    headers = {"Authorization": f"Bearer {target.service.new_key('attacker', scope)}"}
    answers = (
        told(target.ask(method, path, headers=headers))
        for method, path in _operations(target)
        if method in methods and path not in _KEYLESS
    )
    return all_of(answers)


def _keyless(target: Target) -> str:
    answers = (
        told(target.ask(method, path, headers={"Authorization": ""}))
        for method, path in _operations(target)
        if path not in _KEYLESS
    )
    return all_of(answers)


ATTACKS = (
    Attack("no key, every operation", "401 unauthenticated", _keyless),
    Attack(
        "a revoked key with every scope, every operation",
        "401 unauthenticated",
        lambda t: _with_key(t, None, revoked=True),
    ),
    Attack(
        "an expired key with every scope, every operation",
        "401 unauthenticated",
        lambda t: _with_key(t, timedelta(microseconds=1), revoked=False),
    ),
    Attack(
        "a key that may only read, every change",
        "403 missing-scope",
        lambda t: _without_scope(t, Scope.READ, ("POST", "DELETE")),
    ),
    Attack(
        "a key that may only submit, every look",
        "403 missing-scope",
        lambda t: _without_scope(t, Scope.SUBMIT, ("GET",)),
    ),
    Attack("another owner's job, every operation", "404 not-found", _anothers_job),
    Attack(
        "telling another owner's job from one that never was",
        "the same words",
        _anothers_job_as_one_that_never_was,
    ),
    Attack("another owner's job in lists and behind cursors", "not listed", _anothers_jobs_listed),
    Attack("another owner's `Idempotency-Key`", "202, a job of its own", _anothers_idempotency_key),
)
