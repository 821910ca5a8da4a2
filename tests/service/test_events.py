"""Following a job over HTTP."""

import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta

import httpx
import psutil
import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from jobs.event_stream import events_key
from jobs.redis_client import make_redis
from schemas.job import JobState, Progress, Stage
from schemas.problem import ProblemType
from service.keys import keyring
from service.keys.key_file import KeyFile
from service.settings import ServiceSettings
from tests.redis_server import RedisServer
from tests.service.callers import bearer, new_key
from tests.service.conftest import Api
from tests.service.event_stream import Heard, heard, listening
from tests.service.jobs_done import claim, finish
from tests.service.test_jobs import problem_of, submitted


@pytest.fixture
def own_redis(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RedisServer]:
    server = RedisServer(tmp_path_factory.mktemp("redis"))
    server.start()
    yield server
    server.kill()


@pytest.fixture
def own_api(
    own_redis: RedisServer, settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> Api:
    """A service whose heart beats fast, over a Redis of its own."""
    quick = {"redis_url": own_redis.url, "event_heartbeat_s": 0.3, "max_listeners": 60}
    return serve(settings.model_copy(update=quick))


def states(events: list[Heard]) -> list[str]:
    return [event.data["state"] for event in events if event.event == "state"]


def ended(api: Api, state: JobState = JobState.SUCCEEDED, steps: int = 3) -> str:
    """A job that has been through it all."""
    job_id = submitted(api)
    token = claim(api.records, job_id)
    for step in range(steps):
        api.records.advanced(
            job_id, token, Progress(stage=Stage.FITTING, iteration=step, loss=0.5, eta_s=2.0)
        )
    api.records.released(job_id, token)
    finish(api.store, api.records, job_id, state)
    return job_id


def test_a_whole_life(api: Api) -> None:
    job_id = ended(api)
    with listening(api, job_id) as stream:
        headers = stream.answer.headers
        events = list(stream)
    assert headers["content-type"].startswith("text/event-stream")
    assert headers["cache-control"] == "no-store"
    assert headers["x-accel-buffering"] == "no"
    assert stream.retry_ms == api.settings.poll_after_s * 1000
    assert states(events) == ["queued", "running", "queued", "running", "succeeded"]
    progress = [event.data for event in events if event.event == "progress"]
    assert [step["iteration"] for step in progress] == [0, 1, 2]
    assert progress[0].keys() == {
        *("fraction", "stage", "frame", "level", "iteration", "loss", "eta_s"),
    }
    assert events[-1].data == api.client.get(f"/v1/jobs/{job_id}").json()


def test_the_job_says_where_its_events_are(api: Api) -> None:
    job_id = submitted(api)
    links = api.client.get(f"/v1/jobs/{job_id}").json()["links"]
    assert links["events"] == f"/v1/jobs/{job_id}/events"


def test_after_each_event_comes_exactly_the_rest(api: Api) -> None:
    job_id = ended(api)
    events = heard(api, job_id)
    for place, event in enumerate(events[:-1]):
        assert heard(api, job_id, event.id) == events[place + 1 :]


def test_who_has_heard_the_end_is_told_to_stay_away(api: Api) -> None:
    """An EventSource connects again after every end, but not after a 204."""
    job_id = ended(api)
    last = heard(api, job_id)[-1].id
    url = f"/v1/jobs/{job_id}/events"
    answer = api.client.get(url, headers={"Last-Event-ID": last})
    assert (answer.status_code, answer.content) == (204, b"")
    assert api.client.get(url, params={"last_event_id": last}).status_code == 204
    api.records.forget(job_id)
    (standing,) = heard(api, job_id, last)
    assert standing.data["state"] == "succeeded"
    assert api.client.get(url, headers={"Last-Event-ID": standing.id}).status_code == 204


def test_two_connections_hear_what_one_does(api: Api) -> None:
    job_id = submitted(api)
    with listening(api, job_id) as first:
        token = claim(api.records, job_id)
        before = [first.next() for _ in range(2)]
        api.records.advanced(job_id, token, Progress(fraction=0.2))
        before.append(first.next())
    api.records.advanced(job_id, token, Progress(fraction=0.4))
    with listening(api, job_id, before[-1].id) as second:
        after = [second.next()]
        api.records.released(job_id, token)
        finish(api.store, api.records, job_id, JobState.FAILED)
        after += list(second)
    assert before + after == heard(api, job_id)


def test_events_come_at_once(api: Api) -> None:
    job_id = submitted(api)
    with listening(api, job_id) as stream:
        stream.next()
        token = claim(api.records, job_id)
        stream.next()
        lags = []
        for step in range(10):
            api.records.advanced(job_id, token, Progress(iteration=step))
            since = time.monotonic()
            assert stream.next().data["iteration"] == step
            lags.append(time.monotonic() - since)
    assert sorted(lags)[5] < 0.25


def test_a_silent_stream_says_that_it_is_alive(own_api: Api) -> None:
    job_id = submitted(own_api)
    with listening(own_api, job_id) as stream:
        assert stream.next().data["state"] == "queued"
        threading.Timer(1.2, own_api.records.request_cancel, [job_id]).start()
        assert stream.next().data["state"] == "cancelled"
    assert len(stream.comments) >= 2


def test_cancelling_ends_the_stream(api: Api) -> None:
    job_id = submitted(api)
    with listening(api, job_id) as stream:
        api.client.post(f"/v1/jobs/{job_id}/cancel")
        assert states(list(stream)) == ["queued", "cancelled"]


def test_erasing_ends_the_stream(api: Api) -> None:
    job_id = submitted(api)
    claim(api.records, job_id)
    with listening(api, job_id) as stream:
        stream.next()
        start = time.monotonic()
        api.client.delete(f"/v1/jobs/{job_id}")
        assert states(list(stream)) == ["running", "cancelling"]
    assert time.monotonic() - start < 5.0
    problem_of(api.client.get(f"/v1/jobs/{job_id}/events"), 404, ProblemType.NOT_FOUND)


@pytest.mark.parametrize("lost", ["the stream", "the record", "everything"])
def test_long_after_the_end_the_folder_tells_it(
    api: Api, redis_server: RedisServer, lost: str
) -> None:
    job_id = ended(api, JobState.FAILED)
    with make_redis(redis_server.url) as redis:
        if lost == "the stream":
            redis.delete(events_key(job_id))
        elif lost == "the record":
            api.records.forget(job_id)
        else:
            redis.flushall()
    (told,) = heard(api, job_id)
    assert told.event == "state"
    assert told.data == api.client.get(f"/v1/jobs/{job_id}").json()


@pytest.mark.parametrize("job_id", ["0" * 32, "nonsense"])
def test_unknown_jobs(api: Api, job_id: str) -> None:
    problem_of(api.client.get(f"/v1/jobs/{job_id}/events"), 404, ProblemType.NOT_FOUND)


def test_who_takes_no_event_stream_is_told_so(api: Api) -> None:
    job_id = ended(api)
    url = f"/v1/jobs/{job_id}/events"
    refused = api.client.get(url, headers={"Accept": "application/json"})
    problem = problem_of(refused, 406, ProblemType.NOT_ACCEPTABLE)
    assert "Accept: text/event-stream" in problem.detail
    for accept in ("text/event-stream", "text/*", "*/*", "application/json, */*;q=0.1"):
        assert api.client.get(url, headers={"Accept": accept}).status_code == 200


@hypothesis_settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    text=st.text(st.characters(codec="latin-1", exclude_categories=["Cc"]), max_size=60).map(
        str.strip
    )
)
def test_any_text_for_an_id_is_the_beginning(api: Api, text: str) -> None:
    jobs = api.client.get("/v1/jobs").json()["jobs"]
    job_id = jobs[0]["id"] if jobs else ended(api)
    url = f"/v1/jobs/{job_id}/events"
    whole = api.client.get(url).content
    as_header = api.client.get(url, headers={b"Last-Event-ID": text.encode("latin-1")})
    as_query = api.client.get(url, params={"last_event_id": text})
    for answer in (as_header, as_query):
        assert (answer.status_code, answer.content) == (200, whole)


@pytest.mark.parametrize("text", ["18446744073709551615-0", "99999999999999-7"])
def test_an_id_that_is_not_yet_gets_the_job_as_it_stands(api: Api, text: str) -> None:
    job_id = ended(api)
    (told,) = heard(api, job_id, text)
    assert told.data["state"] == "succeeded"
    assert told.id == heard(api, job_id)[-1].id


def test_the_header_counts_before_the_query(api: Api) -> None:
    job_id = ended(api)
    events = heard(api, job_id)
    answer = api.client.get(
        f"/v1/jobs/{job_id}/events",
        headers={"Last-Event-ID": events[-1].id},
        params={"last_event_id": events[0].id},
    )
    assert answer.status_code == 204


def follow(url: str, is_open: threading.Barrier) -> str:
    with (
        httpx.Client(timeout=30.0) as client,
        client.stream("GET", url) as answer,
    ):
        lines = answer.iter_lines()
        text = "\n".join(next(lines) for _ in range(3))
        is_open.wait(timeout=30.0)
        # How often the heart beats meanwhile, each time with a blank line, is the machine's affair.
        return "\n".join([text, *(line for line in lines if line and not line.startswith(":"))])


def test_fifty_listeners_hear_the_same_over_a_handful_of_connections(
    own_api: Api, own_redis: RedisServer
) -> None:
    """And when they are gone nothing of them is left."""
    job_id = submitted(own_api)
    process = psutil.Process()
    with make_redis(own_redis.url) as redis, ThreadPoolExecutor(50) as listeners:
        connections, sockets = len(redis.client_list()), len(process.net_connections())
        is_open = threading.Barrier(51)
        url = f"{own_api.client.base_url}/v1/jobs/{job_id}/events"
        following = [listeners.submit(follow, url, is_open) for _ in range(50)]
        is_open.wait(timeout=30.0)
        own_api.records.released(job_id, claim(own_api.records, job_id))
        during = len(redis.client_list())
        finish(own_api.store, own_api.records, job_id, JobState.SUCCEEDED)
        texts = {one.result(timeout=30.0) for one in following}
        assert len(texts) == 1
        # Four that all readers share; the others are of this test.
        assert during <= connections + 6
        wait_until(lambda: len(redis.client_list()) <= connections + 6)
        wait_until(lambda: len(process.net_connections()) <= sockets + 12)


def wait_until(is_so: Callable[[], bool], within_s: float = 10.0) -> None:
    deadline = time.monotonic() + within_s
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_who_hangs_up_leaves_a_place(
    settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> None:
    api = serve(settings.model_copy(update={"max_listeners": 2}))
    job_id = submitted(api)
    url = f"/v1/jobs/{job_id}/events"
    for _ in range(5):
        with listening(api, job_id) as one, listening(api, job_id) as two:
            assert one.next() == two.next()
            refused = api.client.get(url)
            problem = problem_of(refused, 503, ProblemType.UNAVAILABLE)
            assert "poll" in problem.detail
            assert int(refused.headers["retry-after"]) > 0
        wait_until(lambda: _has_a_place(api, url))


def _has_a_place(api: Api, url: str) -> bool:
    with api.client.stream("GET", url) as answer:
        return answer.status_code == 200


@pytest.mark.parametrize("how", ["kill", "freeze"])
def test_a_stream_outlives_an_outage_of_redis(
    own_api: Api, own_redis: RedisServer, how: str
) -> None:
    """Killed, this Redis forgets everything: the folder brings the job back."""
    job_id = submitted(own_api)
    with listening(own_api, job_id) as stream:
        assert stream.next().data["state"] == "queued"
        getattr(own_redis, how)()
        time.sleep(2.5)
        if how == "kill":
            own_redis.start()
            assert stream.next().data["state"] == "queued"
        else:
            own_redis.thaw()
        finish(own_api.store, own_api.records, job_id, JobState.SUCCEEDED)
        assert states(list(stream)) == ["running", "succeeded"]
    if how == "kill":
        assert any("cannot be reached" in comment for comment in stream.comments)


def test_without_redis_nobody_can_begin_to_listen(own_api: Api, own_redis: RedisServer) -> None:
    job_id = submitted(own_api)
    own_redis.kill()
    answer = own_api.client.get(f"/v1/jobs/{job_id}/events")
    problem_of(answer, 503, ProblemType.UNAVAILABLE)


@pytest.mark.parametrize("end", ["revoked", "expired"])
def test_a_stream_ends_within_seconds_of_its_key(keyed: Api, end: str) -> None:
    data_dir = keyed.settings.data_dir
    lifetime = timedelta(seconds=3) if end == "expired" else None
    key_id, token = new_key(data_dir, "ours", lifetime=lifetime)
    keyed.client.headers.update(bearer(token))
    job_id = submitted(keyed)
    with listening(keyed, job_id) as stream:
        assert stream.next().data["state"] == "queued"
        if end == "revoked":
            keyring.revoke(KeyFile(data_dir), key_id)
        assert list(stream) == []
    assert keyed.client.get(f"/v1/jobs/{job_id}").status_code == 401


def test_a_stream_of_anybody_ends_with_the_first_key(
    settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> None:
    api = serve(settings)
    job_id = submitted(api)
    with listening(api, job_id) as stream:
        stream.next()
        new_key(settings.data_dir, "ours")
        assert list(stream) == []
