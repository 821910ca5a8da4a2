"""What /metrics says: by its own parser, against jobs whose fate is known."""

import re
import shutil
import time
from pathlib import Path

from prometheus_client.parser import text_string_to_metric_families

from schemas.job import JobState
from tests.service.conftest import Api
from tests.service.jobs_done import finish
from tests.service.test_jobs import submitted

ROOT = Path(__file__).parents[2]


def samples(api: Api) -> dict[str, dict[tuple[str, ...], float]]:
    """Values by name and label values, these by their labels' names."""
    found: dict[str, dict[tuple[str, ...], float]] = {}
    for family in text_string_to_metric_families(api.client.get("/metrics").text):
        for sample in family.samples:
            found.setdefault(sample.name, {})[
                tuple(value for _, value in sorted(sample.labels.items()))
            ] = sample.value
    return found


def test_every_metric_is_documented_with_its_type_and_no_other_is(api: Api) -> None:
    submitted(api)
    finish(api.store, api.records, submitted(api), JobState.SUCCEEDED)
    api.workers.heartbeat("worker@test")
    answered = {
        (family.name + ("_total" if family.type == "counter" else ""), family.type)
        for family in text_string_to_metric_families(api.client.get("/metrics").text)
        if not family.name.endswith("_created")
    }
    rows = re.findall(
        r"^\| `(neuralmri_\w+)` \| (\w+) \|", (ROOT / "docs" / "deploy.md").read_text(), re.M
    )
    assert set(rows) == answered


def test_ends_and_attempts_are_counted(api: Api) -> None:
    for state in (JobState.SUCCEEDED, JobState.SUCCEEDED, JobState.FAILED):
        finish(api.store, api.records, submitted(api), state)
    found = samples(api)
    assert found["neuralmri_jobs_ended_total"] == {
        ("none", "contours", "succeeded"): 2.0,
        ("none", "contours", "failed"): 1.0,
    }
    assert found["neuralmri_attempts_total"] == {(): 3.0}
    assert found["neuralmri_workers_lost_total"] == {(): 0.0}
    assert found["neuralmri_stage_duration_seconds_count"] == {("waiting",): 3.0}


def test_the_oldest_queued_job_is_as_old_as_it_is(api: Api) -> None:
    age = "neuralmri_oldest_queued_job_age_seconds"
    assert samples(api)[age] == {(): 0.0}
    first = submitted(api)
    time.sleep(0.3)
    submitted(api)
    assert 0.3 <= samples(api)[age][()] < 5.0
    api.client.post(f"/v1/jobs/{first}/cancel")
    assert samples(api)[age][()] < 0.3 + 5.0


def test_the_stores_room_is_said_as_the_system_has_it(api: Api) -> None:
    found = samples(api)
    usage = shutil.disk_usage(api.store.root)
    assert found["neuralmri_store_size_bytes"] == {(): float(usage.total)}
    assert abs(found["neuralmri_store_free_bytes"][()] - usage.free) < 1e9
    assert found["neuralmri_store_up"] == {(): 1.0}
    api.store.root.rmdir()
    found = samples(api)
    api.store.root.mkdir()
    assert found["neuralmri_store_up"] == {(): 0.0}
    assert "neuralmri_store_free_bytes" not in found


def test_labels_have_few_values_whatever_callers_do(api: Api) -> None:
    for number in range(20):
        api.client.get(f"/v1/jobs/{number:032x}")
        api.client.get(f"/nowhere/{number}")
        api.client.request(f"METHOD{number}", "/v1/jobs")
    label_values = {value for kinds in samples(api).values() for kind in kinds for value in kind}
    assert not {value for value in label_values if "nowhere" in value or "METHOD" in value}
    assert len(samples(api)["neuralmri_http_requests_total"]) < 100


def test_readiness_is_said_part_by_part(api: Api) -> None:
    assert samples(api)["neuralmri_ready"] == {
        ("issuer",): 1.0,
        ("redis",): 1.0,
        ("store",): 1.0,
        ("workers",): 0.0,
    }
    api.workers.heartbeat("worker@test")
    assert samples(api)["neuralmri_ready"][("workers",)] == 0.0, "alive, and nothing done"
    api.workers.finished_heartbeat()
    assert samples(api)["neuralmri_ready"][("workers",)] == 1.0
    assert api.client.get("/readyz").is_success
    api.store.root.rmdir()
    api.store.root.symlink_to("nowhere")
    found = samples(api)["neuralmri_ready"]
    api.store.root.unlink()
    api.store.root.mkdir()
    assert found == {("issuer",): 1.0, ("redis",): 1.0, ("store",): 0.0, ("workers",): 1.0}


def test_what_was_put_into_quarantine_is_counted(api: Api) -> None:
    assert samples(api)["neuralmri_quarantined_folders"] == {(): 0.0}
    (api.store.root / "stranger").mkdir()
    assert api.store.set_aside([]) == ("stranger",)
    assert samples(api)["neuralmri_quarantined_folders"] == {(): 1.0}
