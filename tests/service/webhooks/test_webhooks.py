"""Webhooks as callers use them: over HTTP, with a receiver of their own."""

import base64
import hashlib
import hmac
import json
import time
from collections.abc import Callable
from datetime import datetime
from typing import Any

import pytest
from redis import Redis

from schemas.job import JobState
from schemas.messages import ANONYMOUS
from schemas.problem import InputError, ProblemType
from schemas.webhook import WebhookMessage
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from service.webhooks.desk import WebhookDesk
from tests.service.conftest import Api
from tests.service.jobs_done import finish
from tests.service.test_jobs import problem_of, submitted
from tests.service.webhooks.receiver import Received, Receiver, Reply
from tests.service.webhooks.registering import ended_deliveries, register
from tests.service.webhooks.test_dispatcher import wait_until

ABSENT = "ep_" + "0" * 24


def is_signed(message: Received, secret: str) -> bool:
    """Computed here from the specification's words, not by the code under test."""
    signed = f"{message.id}.{message.headers['webhook-timestamp']}.".encode() + message.body
    key = base64.b64decode(secret.removeprefix("whsec_"))
    ours = base64.b64encode(hmac.new(key, signed, hashlib.sha256).digest()).decode()
    return f"v1,{ours}" in message.headers["webhook-signature"].split(" ")


@pytest.mark.parametrize("state", [JobState.SUCCEEDED, JobState.FAILED])
def test_the_end_of_a_job_is_told_once_signed_and_without_the_patient(
    hooks: Api, receiver: Receiver, state: JobState
) -> None:
    hook = register(hooks, receiver.url, label="ward 3")
    job_id = submitted(hooks)
    finish(hooks.store, hooks.records, job_id, state)
    (delivery,) = ended_deliveries(hooks, hook["id"])
    time.sleep(0.3)
    (message,) = receiver.received
    assert is_signed(message, hook["secret"])
    assert abs(int(message.headers["webhook-timestamp"]) - time.time()) < 10
    assert len(message.body) < 20_000
    body = json.loads(message.body)
    WebhookMessage.model_validate_json(message.body)
    assert body["type"] == f"job.{state}"
    assert datetime.fromisoformat(body["timestamp"]).utcoffset() is not None
    assert body["data"] == {
        "job_id": job_id,
        "state": state,
        "links": {
            "self": f"/v1/jobs/{job_id}",
            "report": f"/v1/jobs/{job_id}/report",
            "artifacts": f"/v1/jobs/{job_id}/artifacts",
        },
    }
    told = message.body.decode() + json.dumps(message.headers)
    assert CONTOUR_REQUEST["study"]["subject_id"] not in told
    assert (delivery["id"], delivery["event"]) == (message.id, f"job.{state}")
    assert (delivery["job_id"], delivery["state"]) == (job_id, "delivered")
    assert [a["status"] for a in delivery["attempts"]] == [204]


def test_a_cancelled_job_is_told_of(hooks: Api, receiver: Receiver) -> None:
    register(hooks, receiver.url, events=["job.cancelled"])
    done, cancelled = submitted(hooks), submitted(hooks)
    finish(hooks.store, hooks.records, done, JobState.SUCCEEDED)
    hooks.client.post(f"/v1/jobs/{cancelled}/cancel")
    (message,) = receiver.wait_for(1)
    time.sleep(0.3)
    assert json.loads(message.body)["data"]["job_id"] == cancelled
    assert len(receiver.received) == 1


def test_the_secret_is_shown_once(hooks: Api, receiver: Receiver) -> None:
    hook = register(hooks, receiver.url, events=["job.failed"], label="ward 3")
    secret = hook.pop("secret")
    assert hooks.client.get(f"/v1/webhooks/{hook['id']}").json() == hook
    listed = hooks.client.get("/v1/webhooks")
    assert listed.json() == {"webhooks": [hook]}
    assert secret not in listed.text


def test_a_rotated_secret_signs_beside_the_new_one(hooks: Api, receiver: Receiver) -> None:
    hook = register(hooks, receiver.url)
    rotated = hooks.client.post(f"/v1/webhooks/{hook['id']}/rotate").json()
    assert rotated["secret"] != hook["secret"]
    tried = hooks.client.post(f"/v1/webhooks/{hook['id']}/test")
    assert (tried.status_code, tried.json()["state"]) == (202, "pending")
    (message,) = receiver.wait_for(1)
    assert message.id == tried.json()["id"]
    assert json.loads(message.body)["type"] == "webhook.test"
    assert json.loads(message.body)["data"] == {"webhook_id": hook["id"]}
    assert is_signed(message, hook["secret"])
    assert is_signed(message, rotated["secret"])


def test_a_failure_is_tried_again_under_the_same_id_and_noted(
    hooks: Api, receiver: Receiver
) -> None:
    receiver.replies = [Reply(500, body=b"no room " * 100), Reply(302, {"Location": "/other"})]
    hook = register(hooks, receiver.url)
    hooks.client.post(f"/v1/webhooks/{hook['id']}/test")
    (delivery,) = ended_deliveries(hooks, hook["id"])
    assert delivery["state"] == "delivered"
    assert [a["status"] for a in delivery["attempts"]] == [500, 302, 204]
    assert delivery["attempts"][0]["answer"] == ("no room " * 100)[:200]
    assert [a["error"] is None for a in delivery["attempts"]] == [False, False, True]
    assert {message.id for message in receiver.received} == {delivery["id"]}
    assert {message.path for message in receiver.received} == {"/hook"}
    assert len({message.body for message in receiver.received}) == 1


def test_retry_after_is_honoured(hooks: Api, receiver: Receiver) -> None:
    receiver.replies = [Reply(503, {"Retry-After": "1"})]
    register_and_test(hooks, receiver)
    first, second = receiver.wait_for(2)
    assert second.at_s - first.at_s >= 0.95


def test_a_delivery_that_failed_for_good_can_be_sent_anew(hooks: Api, receiver: Receiver) -> None:
    receiver.otherwise = Reply(500)
    hook = register_and_test(hooks, receiver)
    (failed,) = ended_deliveries(hooks, hook["id"])
    assert failed["state"] == "failed"
    assert len(failed["attempts"]) == 4, "as many as the schedule has"
    receiver.otherwise = Reply(200)
    replay = f"/v1/webhooks/{hook['id']}/deliveries/{failed['id']}/replay"
    again = hooks.client.post(replay)
    assert (again.status_code, again.json()["state"]) == (202, "pending")
    (delivered,) = ended_deliveries(hooks, hook["id"])
    assert (delivered["id"], delivered["state"]) == (failed["id"], "delivered")
    hooks.client.post(replay)
    receiver.wait_for(6)
    assert len({message.id for message in receiver.received}) == 1


def test_410_disables_and_enabling_sends_what_waits(hooks: Api, receiver: Receiver) -> None:
    receiver.replies = [Reply(410)]
    hook = register_and_test(hooks, receiver)
    (gone,) = ended_deliveries(hooks, hook["id"])
    assert gone["state"] == "failed"
    here = f"/v1/webhooks/{hook['id']}"
    # Noted right after what became of the message, and not with it.
    wait_until(lambda: hooks.client.get(here).json()["disabled_at"] is not None)
    shown = hooks.client.get(here).json()
    assert (shown["disabled_because"], bool(shown["disabled_at"])) == ("it answered 410 Gone", True)
    for refused in (f"{here}/test", f"{here}/deliveries/{gone['id']}/replay"):
        problem = problem_of(hooks.client.post(refused), 409, ProblemType.WEBHOOK_DISABLED)
        assert f"{here}/enable" in problem.detail
    finish(hooks.store, hooks.records, submitted(hooks), JobState.SUCCEEDED)
    time.sleep(0.3)
    assert hooks.client.post(f"{here}/enable").json()["disabled_at"] is None
    hooks.client.post(f"{here}/test")
    receiver.wait_for(2)
    assert json.loads(receiver.received[1].body)["type"] == "webhook.test"


def test_an_endpoint_that_only_fails_is_disabled(
    redis: Redis,
    hook_settings: ServiceSettings,
    serve: Callable[[ServiceSettings], Api],
    receiver: Receiver,
) -> None:
    receiver.otherwise = Reply(500)
    api = serve(hook_settings.model_copy(update={"webhook_disable_after_s": 0.05}))
    hook = register_and_test(api, receiver)
    deadline = time.monotonic() + 10.0
    while not (shown := api.client.get(f"/v1/webhooks/{hook['id']}").json())["disabled_at"]:
        assert time.monotonic() < deadline
        time.sleep(0.02)
    assert "has failed" in shown["disabled_because"]
    sent = len(receiver.received)
    time.sleep(0.5)
    assert len(receiver.received) == sent
    receiver.otherwise = Reply(204)
    api.client.post(f"/v1/webhooks/{hook['id']}/enable")
    (delivered,) = ended_deliveries(api, hook["id"])
    assert delivered["state"] == "delivered", "what waited was kept"


def test_a_removed_endpoint_hears_no_more(hooks: Api, receiver: Receiver) -> None:
    receiver.otherwise = Reply(500)
    hook = register_and_test(hooks, receiver)
    receiver.wait_for(1)
    assert hooks.client.delete(f"/v1/webhooks/{hook['id']}").status_code == 204
    time.sleep(0.3)
    heard = len(receiver.received)
    time.sleep(0.5)
    assert len(receiver.received) == heard
    assert hooks.client.get("/v1/webhooks").json() == {"webhooks": []}
    gone = hooks.client.delete(f"/v1/webhooks/{hook['id']}")
    problem_of(gone, 404, ProblemType.NOT_FOUND)


def test_a_slow_endpoint_does_not_hold_up_another(hooks: Api, receiver: Receiver) -> None:
    slow = register(hooks, f"http://127.0.0.1:{receiver.port}/slow")
    quick = register(hooks, receiver.url)
    receiver.before_reply = lambda: receiver.received[-1].path == "/slow" and time.sleep(1.0)
    for _ in range(10):
        hooks.client.post(f"/v1/webhooks/{slow['id']}/test")
    receiver.wait_for(2)
    hooks.client.post(f"/v1/webhooks/{quick['id']}/test")
    start = time.monotonic()
    assert ended_deliveries(hooks, quick["id"])[0]["state"] == "delivered"
    assert time.monotonic() - start < 0.9
    assert len(receiver.received) <= 3 + 2, "two at a time for one endpoint"


def test_two_services_send_once(
    hooks: Api,
    hook_settings: ServiceSettings,
    serve: Callable[[ServiceSettings], Api],
    receiver: Receiver,
) -> None:
    other = serve(hook_settings)
    hook = register(other, receiver.url)
    jobs = [submitted(other) for _ in range(5)]
    for job_id in jobs:
        finish(other.store, other.records, job_id, JobState.SUCCEEDED)
    ended_deliveries(hooks, hook["id"], 5)
    time.sleep(0.3)
    assert sorted(json.loads(m.body)["data"]["job_id"] for m in receiver.received) == sorted(jobs)


def test_the_log_is_newest_first_and_capped(hooks: Api, receiver: Receiver) -> None:
    hook = register(hooks, receiver.url)
    sent = [hooks.client.post(f"/v1/webhooks/{hook['id']}/test").json()["id"] for _ in range(4)]
    ended_deliveries(hooks, hook["id"], 4)
    listed = hooks.client.get(f"/v1/webhooks/{hook['id']}/deliveries?limit=3").json()["deliveries"]
    assert [delivery["id"] for delivery in listed] == sent[:0:-1]
    too_many = hooks.client.get(f"/v1/webhooks/{hook['id']}/deliveries?limit=201")
    problem_of(too_many, 422, ProblemType.INVALID_REQUEST)


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({}, "/url"),
        ({"url": "https://hooks.example.org/", "events": []}, "/events"),
        ({"url": "https://hooks.example.org/", "events": ["webhook.test"]}, "/events/0"),
        ({"url": "https://hooks.example.org/", "secret": "mine"}, "/secret"),
        ({"url": "https://hooks.example.org/" + "x" * 2048}, "/url"),
        ({"url": 7}, "/url"),
    ],
)
def test_a_registration_that_does_not_fit(
    shared_api: Api, body: dict[str, Any], pointer: str
) -> None:
    answer = shared_api.client.post("/v1/webhooks", json=body)
    assert problem_of(answer, 422, ProblemType.INVALID_REQUEST).pointer == pointer
    wrong_type = shared_api.client.post("/v1/webhooks", data={"url": "x"})
    problem_of(wrong_type, 415, ProblemType.UNSUPPORTED_MEDIA_TYPE)


@pytest.mark.parametrize(
    "url",
    [
        *("http://93.184.215.14/", "https://127.0.0.1/", "https://localhost/", "https://[::1]/"),
        *("https://169.254.169.254/latest/meta-data", "https://10.0.0.1/", "https://0.0.0.0/"),
        *("https://[::ffff:10.0.0.1]/", "https://[64:ff9b::a00:1]/", "https://100.64.0.1/"),
        *(
            "https://user:secret@93.184.215.14/",
            "https://93.184.215.14:6379/",
            "https://2130706433/",
        ),
        *("https://does-not-exist.invalid/", "ftp://93.184.215.14/"),
    ],
)
def test_a_target_inside_is_refused_at_registration(shared_api: Api, url: str) -> None:
    answer = shared_api.client.post("/v1/webhooks", json={"url": url})
    problem = problem_of(answer, 422, ProblemType.WEBHOOK_TARGET_REFUSED)
    assert (problem.pointer, "Remedy" in problem.detail) == ("/url", True)
    assert shared_api.client.get("/v1/webhooks").json() == {"webhooks": []}


def test_there_is_a_limit_to_endpoints(
    redis: Redis,
    hook_settings: ServiceSettings,
    serve: Callable[[ServiceSettings], Api],
    receiver: Receiver,
) -> None:
    api = serve(hook_settings.model_copy(update={"webhook_max_endpoints": 1}))
    register(api, receiver.url)
    again = api.client.post("/v1/webhooks", json={"url": receiver.url})
    assert "remove one" in problem_of(again, 422, ProblemType.INVALID_REQUEST).detail


@pytest.mark.parametrize("webhook_id", [ABSENT, "nonsense", "ep_..", "%2e%2e"])
@pytest.mark.parametrize(
    ("method", "path"),
    [
        *(("GET", ""), ("DELETE", ""), ("POST", "/rotate"), ("POST", "/enable"), ("POST", "/test")),
        *(("GET", "/deliveries"), ("POST", f"/deliveries/msg_{'0' * 32}/replay")),
    ],
)
def test_unknown_webhooks(shared_api: Api, webhook_id: str, method: str, path: str) -> None:
    answer = shared_api.client.request(method, f"/v1/webhooks/{webhook_id}{path}")
    problem_of(answer, 404, ProblemType.NOT_FOUND)


def test_anothers_webhook_is_not_there(
    hook_settings: ServiceSettings, hooks: Api, receiver: Receiver
) -> None:
    hook = register(hooks, receiver.url)
    desk = WebhookDesk.of_settings(hook_settings)
    assert desk.endpoint(hook["id"], ANONYMOUS).id == hook["id"]
    with pytest.raises(InputError, match="no such webhook"):
        desk.endpoint(hook["id"], "somebody else")


def test_unknown_deliveries(hooks: Api, receiver: Receiver) -> None:
    hook = register(hooks, receiver.url)
    for name in ("msg_" + "0" * 32, "nonsense", "endpoint", "%2e%2e"):
        answer = hooks.client.post(f"/v1/webhooks/{hook['id']}/deliveries/{name}/replay")
        assert answer.status_code == 404


def register_and_test(api: Api, receiver: Receiver) -> dict[str, Any]:
    hook = register(api, receiver.url)
    assert api.client.post(f"/v1/webhooks/{hook['id']}/test").status_code == 202
    return hook
