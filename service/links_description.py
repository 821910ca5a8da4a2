"""What the API description says about what can be done next with an answer: OpenAPI links.

An answer that holds a job leads to all that is asked of a job, by the id in it; so do webhooks.
"""

from typing import Any

_JOB = (
    *("submit_contours", "submit_labels", "submit_files"),
    *("restart_job", "get_job", "cancel_job"),
)
_OF_JOB = (
    *("get_job", "job_event_stream", "cancel_job", "restart_job", "erase_job"),
    *("get_request", "get_report", "list_artifacts"),
)
_WEBHOOK = ("register_webhook",)
_OF_WEBHOOK = (
    *("get_webhook", "rotate_webhook_secret", "enable_webhook", "test_webhook"),
    *("list_webhook_deliveries", "remove_webhook"),
)

_ID = "$response.body#/id"


def add_links(description: dict[str, Any]) -> None:
    """Write links into the answers that hold a job, a webhook, a list of files or a delivery."""
    answers = _answers(description)
    for operation in _JOB:
        _lead(answers, operation, _OF_JOB, {"job_id": _ID})
    for operation in _WEBHOOK:
        _lead(answers, operation, _OF_WEBHOOK, {"webhook_id": _ID})
    file = {"job_id": "$request.path.job_id", "name": "$response.body#/artifacts/0/name"}
    _lead(answers, "list_artifacts", ("get_artifact",), file)
    delivery = {"webhook_id": "$request.path.webhook_id", "delivery_id": _ID}
    _lead(answers, "test_webhook", ("replay_webhook_delivery",), delivery)


def _answers(description: dict[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """What each operation answers where all is well."""
    return {
        operation["operationId"]: [
            answer
            for status, answer in operation["responses"].items()
            if status.startswith("2") and status != "204"
        ]
        for operations in description["paths"].values()
        for operation in operations.values()
    }


def _lead(
    answers: dict[str, list[dict[str, Any]]],
    operation: str,
    next_ones: tuple[str, ...],
    parameters: dict[str, str],
) -> None:
    for answer in answers[operation]:
        answer["links"] = {
            name: {"operationId": name, "parameters": dict(parameters)} for name in next_ones
        }
