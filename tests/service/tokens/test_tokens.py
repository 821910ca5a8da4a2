"""The closed table of tokens over HTTP, against a real issuer: who is let in, who is not, and how
it is said.
"""

import json
import time
from collections.abc import Callable
from typing import Any

import pytest

from schemas.problem import ProblemType
from service.settings import ServiceSettings
from service.tokens.opaque_id import opaque_id
from tests.service.callers import Serve, bearer, filled, new_key, operations, submit_as
from tests.service.conftest import Api
from tests.service.event_stream import listening
from tests.service.test_jobs import problem_of
from tests.service.tokens.issuer import AUDIENCE, Issuer

Make = Callable[[Issuer], str]

GOOD: dict[str, Make] = {
    "RS256": lambda issuer: issuer.token(),
    "PS256": lambda issuer: issuer.token(algorithm="PS256"),
    "ES256": lambda issuer: issuer.token("curve", "ES256"),
    "several audiences": lambda issuer: issuer.token(aud=["https://other.test", AUDIENCE]),
    "scopes as a list": lambda issuer: issuer.token(scope=["read", "submit"]),
    "just expired": lambda issuer: issuer.token(exp=int(time.time()) - 2),
    "a clock ahead": lambda issuer: issuer.token(iat=int(time.time()) + 2),
    "without iat": lambda issuer: issuer.token(iat=None),
}

BAD: dict[str, Make] = {
    "expired": lambda issuer: issuer.token(exp=int(time.time()) - 60),
    "not yet": lambda issuer: issuer.token(nbf=int(time.time()) + 60),
    "without an end": lambda issuer: issuer.token(exp=None),
    "another audience": lambda issuer: issuer.token(aud="https://other.test"),
    "no audience": lambda issuer: issuer.token(aud=None),
    "the audience and more": lambda issuer: issuer.token(aud=AUDIENCE + "/"),
    "another issuer": lambda issuer: issuer.token(iss="https://other.test"),
    "no issuer": lambda issuer: issuer.token(iss=None),
    "the issuer with a slash": lambda issuer: issuer.token(iss=issuer.url + "/"),
    "no subject": lambda issuer: issuer.token(sub=None),
    "an empty subject": lambda issuer: issuer.token(sub=""),
    "alg none": lambda issuer: issuer.unsigned(),
    "HS256 with the public key": lambda issuer: issuer.signed_by_what_all_know(),
    "RS512, which does not count": lambda issuer: issuer.token(algorithm="RS512"),
    "unknown key": lambda issuer: issuer.token("third"),
    "another's signature": lambda issuer: _with_signature_of(issuer, issuer.token("third")),
    "another's claims": lambda issuer: _with_claims_of(issuer, issuer.token(sub="eve")),
    "no signature": lambda issuer: issuer.token().rpartition(".")[0] + ".",
    "cut short": lambda issuer: issuer.token()[:-4],
    "two parts": lambda issuer: issuer.token().rpartition(".")[0],
    "nothing": lambda _issuer: "",
    "nonsense": lambda _issuer: "a.b.c",
    "not ASCII": lambda issuer: issuer.token()[:-1] + "é",
    "32 KiB": lambda issuer: issuer.token(pad="x" * 32_000),
}


def _with_signature_of(issuer: Issuer, other: str) -> str:
    return issuer.token().rpartition(".")[0] + "." + other.rpartition(".")[2]


def _with_claims_of(issuer: Issuer, other: str) -> str:
    header, _, signature = issuer.token().split(".")
    return ".".join((header, other.split(".")[1], signature))


def carrying(token: str) -> dict[str, bytes]:
    return {"Authorization": f"Bearer {token}".strip().encode()}


@pytest.mark.parametrize("name", GOOD)
def test_good_tokens_open(api_of_issuer: Api, issuer: Issuer, name: str) -> None:
    headers = bearer(GOOD[name](issuer))
    assert api_of_issuer.client.get("/v1/jobs", headers=headers).status_code == 200


def test_bad_tokens_open_nothing_and_are_told_so(api_of_issuer: Api, issuer: Issuer) -> None:
    api = api_of_issuer
    for name, make in BAD.items():
        token = make(issuer)
        answer = api.client.get("/v1/jobs", headers=carrying(token))
        assert answer.status_code == 401, name
        problem_of(answer, 401, ProblemType.UNAUTHENTICATED)
        challenge = answer.headers["www-authenticate"]
        assert challenge == 'Bearer realm="neuralmri", error="invalid_token"', name
        assert not token or token not in answer.text
        assert "jane" not in answer.text
    audit = (api.settings.data_dir / "audit" / "refused.jsonl").read_text().splitlines()
    assert {json.loads(line)["actor"] for line in audit} == {"unknown"}
    assert len(audit) == len(BAD)


def test_no_token_is_asked_for_one_in_every_operation(api_of_issuer: Api) -> None:
    """Though there is no key: an issuer is reason enough to ask."""
    for method, path in operations(api_of_issuer):
        answer = api_of_issuer.client.request(method, filled(path, "0" * 32))
        assert answer.status_code == 401, (method, path)
        assert answer.headers["www-authenticate"] == 'Bearer realm="neuralmri"'


def test_a_token_in_the_header_of_keys_or_in_the_query_is_none(
    api_of_issuer: Api, issuer: Issuer
) -> None:
    token = issuer.token()
    client = api_of_issuer.client
    assert client.get("/v1/jobs", headers={"X-API-Key": token}).status_code == 401
    assert client.get("/v1/jobs", params={"access_token": token}).status_code == 401
    two = {**bearer(token), "X-API-Key": issuer.token(sub="other")}
    assert client.get("/v1/jobs", headers=two).status_code == 401


def test_keys_and_tokens_open_side_by_side(api_of_issuer: Api, issuer: Issuer) -> None:
    key = new_key(api_of_issuer.settings.data_dir, "ward")[1]
    for headers in (bearer(key), {"X-API-Key": key}, bearer(issuer.token())):
        assert api_of_issuer.client.get("/v1/jobs", headers=headers).status_code == 200


@pytest.mark.parametrize("scope", ["openid profile", "", None, 7, ["reading", 3], {"read": True}])
def test_a_token_without_our_scopes_may_nothing(
    api_of_issuer: Api, issuer: Issuer, scope: Any
) -> None:
    answer = api_of_issuer.client.get("/v1/jobs", headers=bearer(issuer.token(scope=scope)))
    problem_of(answer, 403, ProblemType.MISSING_SCOPE)
    challenge = answer.headers["www-authenticate"]
    assert 'error="insufficient_scope", scope="read"' in challenge


def test_scopes_are_told_apart(api_of_issuer: Api, issuer: Issuer) -> None:
    client = api_of_issuer.client
    submitting = bearer(issuer.token(scope="submit"))
    assert client.get("/v1/jobs", headers=submitting).status_code == 403
    reading = bearer(issuer.token(scope="read"))
    assert client.delete(f"/v1/jobs/{'0' * 32}", headers=reading).status_code == 403
    assert client.get("/v1/jobs", headers=reading).status_code == 200


def test_a_job_is_its_owners_and_there_for_no_other(api_of_issuer: Api, issuer: Issuer) -> None:
    api = api_of_issuer
    job_id = submit_as(api, issuer.token())
    key = new_key(api.settings.data_dir, "ward")[1]
    for token in (issuer.token(sub="eve@hospital.example"), key):
        answer = api.client.get(f"/v1/jobs/{job_id}", headers=bearer(token))
        problem_of(answer, 404, ProblemType.NOT_FOUND)
        assert api.client.get("/v1/jobs", headers=bearer(token)).json()["jobs"] == []
    for token in (issuer.token(), issuer.token(sub="root", scope="admin")):
        assert api.client.get(f"/v1/jobs/{job_id}", headers=bearer(token)).status_code == 200
    owner = api.store.folder(job_id).owner()
    assert owner == opaque_id(issuer.url, "sub", "jane@hospital.example")


def test_who_erased_may_erase_again(api_of_issuer: Api, issuer: Issuer) -> None:
    job_id = submit_as(api_of_issuer, issuer.token())
    ours, other = issuer.token(), issuer.token(sub="eve")
    for token, status in ((ours, 204), (ours, 204), (other, 404)):
        answer = api_of_issuer.client.delete(f"/v1/jobs/{job_id}", headers=bearer(token))
        assert answer.status_code == status


def test_the_audit_log_has_who_it_was_and_neither_name_nor_token(
    api_of_issuer: Api, issuer: Issuer
) -> None:
    api = api_of_issuer
    token = issuer.token()
    job_id = submit_as(api, token)
    api.client.get("/v1/jobs", headers=bearer(issuer.token(scope="none")))
    who = opaque_id(issuer.url, "sub", "jane@hospital.example")
    done, refused = (
        (api.settings.data_dir / "audit" / name).read_text()
        for name in ("done.jsonl", "refused.jsonl")
    )
    line = json.loads(done)
    assert (line["actor"], line["owner"], line["job"]) == (who, who, job_id)
    assert json.loads(refused)["actor"] == who
    assert "jane" not in done + refused
    assert token.rpartition(".")[2] not in done + refused


def test_an_organisation_may_be_the_owner(
    serve: Serve, trusting: ServiceSettings, issuer: Issuer, api: Api
) -> None:
    """Its members share jobs, and the audit log tells them apart."""
    words = "neuralmri.read=read neuralmri.run=submit"
    api = serve(
        trusting.model_copy(
            update={
                "oidc_owner_claim": "org",
                "oidc_scope_claim": "scp",
                "oidc_scopes": words,
                "oidc_jwks_url": f"{issuer.url}/keys",
            }
        )
    )
    scp = ["neuralmri.read", "neuralmri.run"]
    job_id = submit_as(api, issuer.token(org="north", scp=scp))
    colleague, stranger = (issuer.token(sub="joe", org=org, scp=scp) for org in ("north", "south"))
    url = f"/v1/jobs/{job_id}"
    assert api.client.get(url, headers=bearer(colleague)).status_code == 200
    assert api.client.get(url, headers=bearer(stranger)).status_code == 404
    for org in (None, "", 7, ["north"]):
        answer = api.client.get(url, headers=bearer(issuer.token(org=org, scp=scp)))
        assert answer.status_code == 401
    line = json.loads((api.settings.data_dir / "audit" / "done.jsonl").read_text())
    assert line["actor"] == opaque_id(issuer.url, "sub", "jane@hospital.example")
    assert line["owner"] == opaque_id(issuer.url, "org", "north")


def test_a_rotated_key_counts_once_it_is_published(api_of_issuer: Api, issuer: Issuer) -> None:
    client = api_of_issuer.client
    old = bearer(issuer.token())
    new = bearer(issuer.token("second"))
    assert client.get("/v1/jobs", headers=old).status_code == 200
    assert client.get("/v1/jobs", headers=new).status_code == 401
    issuer.rotate()
    time.sleep(api_of_issuer.settings.oidc_refetch_s)
    assert client.get("/v1/jobs", headers=new).status_code == 200
    assert client.get("/v1/jobs", headers=old).status_code == 401


def test_unknown_keys_make_few_questions(
    serve: Serve, trusting: ServiceSettings, issuer: Issuer
) -> None:
    api = serve(trusting.model_copy(update={"oidc_refetch_s": 3600.0}))
    for number in range(20):
        answer = api.client.get("/v1/jobs", headers=bearer(issuer.token(f"unknown{number}")))
        assert answer.status_code == 401
    assert issuer.asked == 1


def test_an_issuer_that_is_down_from_the_start(
    serve: Serve, trusting: ServiceSettings, issuer: Issuer
) -> None:
    """Nobody is let in and nobody is told that a token is bad; once it is up, all is well."""
    issuer.is_down = True
    api = serve(trusting)
    key = new_key(api.settings.data_dir, "ward")[1]
    answer = api.client.get("/v1/jobs", headers=bearer(issuer.token()))
    problem = problem_of(answer, 503, ProblemType.UNAVAILABLE)
    assert int(answer.headers["retry-after"]) > 0
    assert "Remedy" in problem.detail
    assert "www-authenticate" not in answer.headers
    assert api.client.get("/v1/jobs", headers=bearer(key)).status_code == 200
    ready = api.client.get("/readyz")
    assert ready.status_code == 503
    assert [p["detail"] for p in ready.json()["errors"] if p["pointer"] == "issuer"] == [
        "the keys of the token issuer cannot be had: it answered 500"
    ]
    issuer.is_down = False
    time.sleep(2 * api.settings.oidc_refetch_s)
    assert api.client.get("/v1/jobs", headers=bearer(issuer.token())).status_code == 200
    assert "issuer" not in [p["pointer"] for p in api.client.get("/readyz").json()["errors"]]


def test_keys_outlive_their_issuer_for_a_while(
    serve: Serve, trusting: ServiceSettings, issuer: Issuer
) -> None:
    api = serve(trusting.model_copy(update={"oidc_stale_s": 2.0, "oidc_refresh_s": 0.2}))
    known, unknown = bearer(issuer.token()), bearer(issuer.token("third"))
    assert api.client.get("/v1/jobs", headers=known).status_code == 200
    issuer.is_down = True
    time.sleep(0.6)
    assert api.client.get("/v1/jobs", headers=known).status_code == 200
    assert api.client.get("/v1/jobs", headers=unknown).status_code == 503, "it may be a new one"
    time.sleep(2.0)
    assert api.client.get("/v1/jobs", headers=known).status_code == 503


def test_a_description_of_another_issuer_is_not_believed(
    serve: Serve, trusting: ServiceSettings, issuer: Issuer
) -> None:
    issuer.described_as = "https://other.test"
    api = serve(trusting)
    assert api.client.get("/v1/jobs", headers=bearer(issuer.token())).status_code == 503


def test_keys_for_other_ends_sign_nothing(
    serve: Serve, trusting: ServiceSettings, issuer: Issuer
) -> None:
    issuer.extra_keys = [
        {"kty": "oct", "k": "c2VjcmV0", "kid": "shared", "alg": "HS256"},
        {"kty": "RSA", "kid": "broken", "n": "AQ", "e": "AQAB"},
        {"kty": "new", "kid": "unheard-of"},
    ]
    issuer.private["first-for-encryption"] = issuer.private["first"]
    api = serve(trusting)
    assert api.client.get("/v1/jobs", headers=bearer(issuer.token())).status_code == 200
    for kid in ("shared", "broken", "unheard-of"):
        answer = api.client.get("/v1/jobs", headers=bearer(issuer.token(kid)))
        assert answer.status_code == 401


def test_a_stream_ends_with_its_token(api_of_issuer: Api, issuer: Issuer) -> None:
    """The leeway counts for streams, too."""
    api = api_of_issuer
    job_id = submit_as(api, issuer.token())
    api.client.headers.update(bearer(issuer.token(exp=int(time.time()) - 3)))
    with listening(api, job_id) as stream:
        assert [event.data["state"] for event in stream] == ["queued"]
    assert api.client.get(f"/v1/jobs/{job_id}").status_code == 401
