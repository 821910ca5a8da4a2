"""What a process writes, in a process of its own: the log is global to one."""

import json
import subprocess
import sys
from typing import Any

from jobs.logs import LogFormat

PROCESS = """
import logging, sys, threading, warnings
from contextvars import copy_context
from jobs import log_context
from jobs.log_context import LogContext
from jobs.logs import LogFormat, write_logs
from jobs.trace_context import TraceContext
from schemas.job import Stage
from schemas.job import Job

logging.getLogger("uvicorn").addHandler(logging.StreamHandler(sys.stdout))
write_logs(LogFormat(sys.argv[1]))
log = logging.getLogger("neuralmri.test")
log.info("before %s", "all")
log.debug("unheard")
logging.getLogger("uvicorn.error").warning("from uvicorn")
logging.getLogger("uvicorn.access").info("GET /v1/jobs?name=heard")
logging.getLogger("celery.app.trace").info("unheard")
context = log_context.enter(LogContext(job_id="0" * 32, trace=TraceContext("a" * 32, "b" * 16)))
context.attempt = 2
thread = threading.Thread(target=copy_context().run, args=(log.info, "in a thread\\nof two lines"))
context.stage = Stage.FITTING
thread.start()
thread.join()
log.info("asked", extra={"fields": {"status": 200}})
warnings.warn("old-fashioned")
try:
    Job.model_validate({"id": {"Jane": "Doe"}})
except ValueError:
    log.exception("refused")
"""


def written(form: LogFormat) -> list[str]:
    ended = subprocess.run(
        [sys.executable, "-c", PROCESS, form.value], capture_output=True, text=True, check=True
    )
    assert ended.stdout == ""
    return ended.stderr.splitlines()


def test_json_is_one_object_an_event_with_what_is_known() -> None:
    lines: list[dict[str, Any]] = [json.loads(line) for line in written(LogFormat.JSON)]
    first, uvicorn, thread, asked, warning, refused = lines
    assert set(first) == {"time", "level", "logger", "message"}
    assert (first["level"], first["logger"], first["message"]) == (
        "info",
        "neuralmri.test",
        "before all",
    )
    assert first["time"].endswith("Z")
    assert uvicorn["logger"] == "uvicorn.error"
    about = {"job_id": "0" * 32, "attempt": 2, "stage": "fitting", "trace_id": "a" * 32}
    assert about.items() <= thread.items()
    assert thread["message"] == "in a thread\nof two lines"
    assert asked["status"] == 200
    assert warning["logger"] == "py.warnings"
    assert "ValidationError" in refused["exception"]


def test_text_says_the_same_for_people() -> None:
    text = "\n".join(written(LogFormat.TEXT))
    assert "INFO neuralmri.test: before all\n" in text
    assert f"[job_id={'0' * 32} attempt=2 stage=fitting trace_id={'a' * 32} status=200]" in text
    assert "ValidationError" in text


def test_a_value_that_a_model_refuses_is_not_logged() -> None:
    for form in LogFormat:
        assert "Jane" not in "".join(written(form))
