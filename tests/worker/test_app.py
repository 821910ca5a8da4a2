"""The worker's parent process as Celery makes it, asked in a fresh interpreter."""

import json
import subprocess
import sys

import pytest

from schemas.messages import HEARTBEAT_TASK, RECONSTRUCT_QUEUE, RECONSTRUCT_TASK

ASK = """
import json, sys
from worker.app import app
app.loader.import_default_modules()
print(json.dumps({
    "conf": {name: app.conf[name] for name in sys.argv[1:]},
    "tasks": sorted(name for name in app.tasks if not name.startswith("celery.")),
    "loaded": sorted({name.partition(".")[0] for name in sys.modules}),
}))
"""


@pytest.fixture(scope="module")
def parent() -> dict[str, object]:
    names = [
        "task_acks_late",
        "task_reject_on_worker_lost",
        "worker_prefetch_multiplier",
        "worker_max_tasks_per_child",
        "worker_pool",
        "accept_content",
        "task_default_queue",
        "worker_enable_remote_control",
    ]
    ended = subprocess.run(
        [sys.executable, "-c", ASK, *names],
        capture_output=True,
        text=True,
        check=True,
    )
    said: dict[str, object] = json.loads(ended.stdout)
    return said


def test_it_knows_its_tasks_by_the_names_that_are_sent(
    parent: dict[str, object],
) -> None:
    assert parent["tasks"] == [HEARTBEAT_TASK, RECONSTRUCT_TASK]


def test_it_loads_no_arithmetic_that_a_fork_would_break(parent: dict[str, object]) -> None:
    loaded = parent["loaded"]
    assert isinstance(loaded, list)
    assert not {"torch", "numpy", "scipy", "igl", "vtk"} & set(loaded)


def test_its_settings_lose_no_job(parent: dict[str, object]) -> None:
    assert parent["conf"] == {
        "task_acks_late": True,
        "task_reject_on_worker_lost": True,
        "worker_prefetch_multiplier": 1,
        "worker_max_tasks_per_child": None,  # it would count heartbeats: see worker/job_pool.py
        "worker_pool": "worker.job_pool:JobPool",
        "accept_content": ["json"],
        "task_default_queue": RECONSTRUCT_QUEUE,
        "worker_enable_remote_control": False,
    }
