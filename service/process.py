"""The API as a process of its own: `uvicorn --factory service.process:app_of_process`."""

import gc
import sys

from fastapi import FastAPI

from jobs import spans
from jobs.logs import write_logs
from jobs.store_errors import StoreMisfit
from service.access import JobAccess
from service.app import create_app
from service.settings import ServiceSettings

_SWITCH_INTERVAL_S = 0.0005
"""How long a thread that judges a study keeps the interpreter from the event loop. At Python's own
5 ms a request that changes threads six times waits for 30 ms beside one submission."""


def app_of_process() -> FastAPI:
    """The application that the environment describes, with the log that it asks for.

    It starts where Redis or the store do not answer, and says that it is not ready; not where the
    store could never keep a job.
    """
    settings = ServiceSettings()
    write_logs(settings.log_format)
    spans.start("neuralmri-service")
    sys.setswitchinterval(_SWITCH_INTERVAL_S)
    try:
        app = create_app(settings)
        access: JobAccess = app.state.access
        access.store.prove()
    except StoreMisfit as error:
        raise SystemExit(f"the job store cannot be used: {error.reason}") from error
    # Modules, models and routes stay for good: every full collection would walk through them,
    # and nobody is answered meanwhile.
    gc.collect()
    gc.freeze()
    return app
