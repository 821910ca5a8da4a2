"""`python -m service.openapi > openapi.yaml` writes the committed API description."""

import sys
import tempfile
from pathlib import Path

import yaml

from service.app import create_app
from service.settings import ServiceSettings


def openapi_yaml() -> str:
    """The description as the committed file has it, from a service that is never started."""
    with tempfile.TemporaryDirectory() as folder:
        app = create_app(ServiceSettings(data_dir=Path(folder)))
        return yaml.safe_dump(app.openapi(), sort_keys=False, allow_unicode=True, width=100)


if __name__ == "__main__":
    sys.stdout.write(openapi_yaml())
