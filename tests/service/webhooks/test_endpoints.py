import os
import stat
import threading
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from schemas.webhook import JobEvent, WebhookRequest
from service.webhooks.endpoint import Endpoint
from service.webhooks.endpoints import Endpoints, TooManyEndpoints

NOW = datetime(2026, 3, 1, 12, 0, tzinfo=UTC)


def endpoint(owner: str = "anna", at: datetime = NOW) -> Endpoint:
    request = WebhookRequest(url="https://hooks.example.org/", label="ward 3")
    return Endpoint.of_request(request, owner, at)


@pytest.fixture
def endpoints(tmp_path: Path) -> Endpoints:
    return Endpoints(tmp_path / "data" / "webhooks")


def test_what_is_stored_is_found_again_by_another_process(endpoints: Endpoints) -> None:
    annas = [endpoint(at=NOW + timedelta(seconds=n)) for n in (2, 0, 1)]
    bobs = endpoint("bob")
    for stored in (*annas, bobs):
        endpoints.add(stored, 10)
    again = Endpoints(endpoints.root)
    assert again.get(bobs.id) == bobs
    assert again.of_owner("anna") == [annas[1], annas[2], annas[0]]
    assert len(again.all()) == 4


def test_secrets_are_for_their_owner_only(endpoints: Endpoints) -> None:
    stored = endpoint()
    endpoints.add(stored, 10)
    endpoints.change(stored.id, lambda e: e.rotated(NOW, 60.0))
    for folder, _, files in os.walk(endpoints.root):
        assert stat.S_IMODE(Path(folder).stat().st_mode) == 0o700
        for name in files:
            assert stat.S_IMODE((Path(folder) / name).stat().st_mode) == 0o600
    left = {path.name for path in (endpoints.root / stored.id).iterdir()}
    assert left == {"endpoint.json", "deliveries"}, "no draft stays behind"


@pytest.mark.parametrize("name", ["", ".", "..", "../..", "ep_", "ep_" + "0" * 24, "ep_/../x"])
def test_unknown_and_malformed_ids(endpoints: Endpoints, name: str) -> None:
    assert endpoints.get(name) is None
    assert endpoints.change(name, Endpoint.enabled) is None
    endpoints.remove(name)
    assert endpoints.root.is_dir()


def test_a_limit_for_each_owner(endpoints: Endpoints) -> None:
    for _ in range(2):
        endpoints.add(endpoint(), 2)
    with pytest.raises(TooManyEndpoints):
        endpoints.add(endpoint(), 2)
    endpoints.add(endpoint("bob"), 2)


def test_a_removed_endpoint_stays_removed(endpoints: Endpoints) -> None:
    stored = endpoint()
    endpoints.add(stored, 10)
    endpoints.remove(stored.id)
    endpoints.remove(stored.id)
    assert endpoints.change(stored.id, Endpoint.enabled) is None
    assert [path.name for path in endpoints.root.iterdir()] == [".lock"]


def test_a_sweep_takes_what_a_crash_left_and_nothing_else(endpoints: Endpoints) -> None:
    stored = endpoint()
    endpoints.add(stored, 10)
    (endpoints.root / ("ep_" + "1" * 24) / "deliveries").mkdir(parents=True)
    (endpoints.root / f".erased-{stored.id}-00").mkdir()
    endpoints.sweep()
    assert sorted(path.name for path in endpoints.root.iterdir()) == [".lock", stored.id]


def test_no_change_is_lost_among_many(endpoints: Endpoints) -> None:
    stored = endpoint()
    endpoints.add(stored, 10)

    def lengthen() -> None:
        for _ in range(10):
            endpoints.change(stored.id, lambda e: e.model_copy(update={"label": f"{e.label}x"}))

    threads = [threading.Thread(target=lengthen) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    changed = endpoints.get(stored.id)
    assert changed is not None
    assert changed.label == "ward 3" + "x" * 40


def test_the_owner_sees_no_secret_and_no_owner() -> None:
    shown = endpoint().public().model_dump()
    assert set(shown) == {
        *("id", "url", "events", "label", "created_at", "disabled_at", "disabled_because")
    }


def test_a_rotated_secret_signs_for_a_while_beside_the_new_one() -> None:
    first = endpoint()
    second = first.rotated(NOW, 60.0)
    old, new = first.with_secret().secret, second.with_secret().secret
    assert old != new
    assert second.live_secrets(NOW + timedelta(seconds=59)) == [new, old]
    assert second.live_secrets(NOW + timedelta(seconds=61)) == [new]
    assert first.rotated(NOW, 0.0).live_secrets(NOW) != [old]


def test_rotating_often_keeps_the_headers_short() -> None:
    often = endpoint()
    for _ in range(20):
        often = often.rotated(NOW, 60.0)
    assert len(often.live_secrets(NOW)) == 4


def test_only_failures_without_a_success_disable() -> None:
    day = timedelta(days=1)
    failing = endpoint().failed(NOW, 5 * 86400.0)
    assert failing.failed(NOW + 4 * day, 5 * 86400.0).disabled_at is None
    disabled = failing.failed(NOW + 5 * day, 5 * 86400.0)
    assert disabled.disabled_at == NOW + 5 * day
    assert disabled.disabled_because == "every attempt since 2026-03-01 12:00 UTC has failed"
    assert not disabled.wants(JobEvent.SUCCEEDED)
    assert disabled.enabled().wants(JobEvent.SUCCEEDED)
    assert failing.answered().failed(NOW + 5 * day, 5 * 86400.0).disabled_at is None
