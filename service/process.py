"""The API as a process of its own: `uvicorn --factory service.process:app_of_process`."""

from fastapi import FastAPI

from jobs.logs import write_logs
from jobs.store_errors import StoreMisfit
from service.access import JobAccess
from service.app import create_app
from service.settings import ServiceSettings


def app_of_process() -> FastAPI:
    """The application that the environment describes, with the log that it asks for.

    It starts where Redis or the store do not answer, and says that it is not ready; not where the
    store could never keep a job.
    """
    settings = ServiceSettings()
    write_logs(settings.log_format)
    try:
        app = create_app(settings)
        access: JobAccess = app.state.access
        access.store.prove()
    except StoreMisfit as error:
        raise SystemExit(f"the job store cannot be used: {error.reason}") from error
    return app
