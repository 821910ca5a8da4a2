"""How a process writes its log: one event a line, as JSON for machines or as text for people."""

import json
import logging
import sys
from datetime import UTC, datetime
from enum import StrEnum
from typing import Any, TextIO

from jobs import log_context

_OUTSPOKEN = ("uvicorn", "uvicorn.error")
"""Loggers that are given handlers before we are asked."""

_UNHEARD = "uvicorn.access"
"""It says paths and queries as callers write them; `service/request_log.py` takes its place."""

_EVERY_TASK = ("celery.worker.strategy", "celery.app.trace")
"""They say of every task what an attempt says of its job; what they warn of is heard."""


class LogFormat(StrEnum):
    """For whom a log is."""

    TEXT = "text"
    JSON = "json"


class JsonFormatter(logging.Formatter):
    """One JSON object a line: `time`, `level`, `logger`, `message`, what the line is about, the
    `fields` that it was given, and `exception` with the traceback where there is one.
    """

    def format(self, record: logging.LogRecord) -> str:
        line: dict[str, Any] = {
            "time": _time(record),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            **log_context.current().fields(),
            **getattr(record, "fields", {}),
        }
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        return json.dumps(line, ensure_ascii=False, default=str)


class TextFormatter(logging.Formatter):
    """The same for people: time, level, logger, message, and the rest in brackets."""

    def format(self, record: logging.LogRecord) -> str:
        known = log_context.current().fields() | getattr(record, "fields", {})
        rest = " ".join(f"{name}={value}" for name, value in known.items())
        line = f"{_time(record)} {record.levelname} {record.name}: {record.getMessage()}"
        line += f" [{rest}]" if rest else ""
        return f"{line}\n{self.formatException(record.exc_info)}" if record.exc_info else line


def write_logs(form: LogFormat, stream: TextIO | None = None) -> None:
    """Have all that this process logs, from INFO on, written to `stream` (standard error).

    Warnings of Python are logged too. Other handlers are taken away.
    """
    handler = logging.StreamHandler(stream or sys.stderr)
    handler.setFormatter(JsonFormatter() if form is LogFormat.JSON else TextFormatter())
    logging.basicConfig(level=logging.INFO, handlers=[handler], force=True)
    logging.captureWarnings(True)
    for name in (*_OUTSPOKEN, _UNHEARD):
        logger = logging.getLogger(name)
        logger.handlers.clear()
        logger.propagate = name != _UNHEARD
    for name in _EVERY_TASK:
        logging.getLogger(name).setLevel(logging.WARNING)


def _time(record: logging.LogRecord) -> str:
    instant = datetime.fromtimestamp(record.created, tz=UTC)
    return instant.isoformat(timespec="milliseconds").replace("+00:00", "Z")
