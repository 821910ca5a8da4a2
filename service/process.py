"""The API as a process of its own: `uvicorn --factory service.process:app_of_process`."""

from fastapi import FastAPI

from jobs import spans
from jobs.logs import write_logs
from service.app import create_app
from service.settings import ServiceSettings


def app_of_process() -> FastAPI:
    """The application that the environment describes, with the log that it asks for."""
    settings = ServiceSettings()
    write_logs(settings.log_format)
    spans.start("neuralmri-service")
    return create_app(settings)
