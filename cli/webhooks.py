"""`neuralmri webhooks list | add | remove | deliveries | replay`: who is told when jobs end."""

from typing import Annotated

import typer
from pydantic import ValidationError

from cli.console import notice_console, say, say_json
from cli.input_arguments import JsonFlag
from cli.server_arguments import (
    DEFAULT_RETRY_WITHIN_S,
    LOCAL_SERVER,
    ApiKeyText,
    RetryWithin,
    ServerUrl,
    connected,
)
from schemas.problem import InputError, ProblemType
from schemas.webhook import Delivery, JobEvent, Webhook, WebhookRequest

webhooks = typer.Typer(
    name="webhooks",
    help="Have endpoints of yours told by a server when jobs end, and see what they were sent.",
    no_args_is_help=True,
)

WebhookId = Annotated[str, typer.Argument(metavar="ID", help="As `webhooks list` shows it.")]
DeliveryId = Annotated[
    str, typer.Argument(metavar="DELIVERY", help="As `webhooks deliveries` shows it.")
]


@webhooks.command("list")
def list_(
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: JsonFlag = False,
) -> None:
    """Your endpoints, oldest first. Never the secret."""
    with connected(server, api_key, retry_within) as client:
        found = client.webhooks.listed()
    if as_json:
        say_json(found.model_dump(mode="json", exclude_none=True))
        return
    for webhook in found.webhooks:
        say(_line(webhook))


@webhooks.command()
def add(
    url: Annotated[str, typer.Argument(metavar="URL", help="Where to POST; https.")],
    event: Annotated[
        list[JobEvent] | None, typer.Option(help="What to tell; once for each.  [default: all]")
    ] = None,
    label: Annotated[str | None, typer.Option(help="For your own eyes.")] = None,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    as_json: JsonFlag = False,
) -> None:
    """Register an endpoint, and show its signing secret, this once.

    A server that does not answer is not asked again: look at `webhooks list` first.
    """
    try:
        request = WebhookRequest(url=url, events=event or list(JobEvent), label=label)
    except ValidationError as error:
        why = error.errors()[0]
        raise InputError(ProblemType.INVALID_REQUEST, f"{why['loc'][0]}: {why['msg']}") from error
    with connected(server, api_key, 0.0) as client:
        made = client.webhooks.add(request)
    if as_json:
        say_json(made.model_dump(mode="json", exclude_none=True))
        return
    notice_console.print(
        f"{_line(made)}; its secret is shown only now:", markup=False, soft_wrap=True
    )
    say(made.secret)


@webhooks.command()
def remove(
    webhook_id: WebhookId,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: JsonFlag = False,
) -> None:
    """Forget an endpoint and its deliveries, those that wait included."""
    with connected(server, api_key, retry_within) as client:
        client.webhooks.remove(webhook_id)
    if as_json:
        say_json({"id": webhook_id, "removed": True})
    else:
        say("removed")


@webhooks.command()
def deliveries(
    webhook_id: WebhookId,
    limit: Annotated[int, typer.Option(min=1, max=200, help="The newest so many.")] = 50,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: JsonFlag = False,
) -> None:
    """What an endpoint was sent, newest first: id, state, event, job, the last answer."""
    with connected(server, api_key, retry_within) as client:
        found = client.webhooks.deliveries(webhook_id, limit)
    if as_json:
        say_json(found.model_dump(mode="json", exclude_none=True))
        return
    for delivery in found.deliveries:
        say(_sent(delivery))


@webhooks.command()
def replay(
    webhook_id: WebhookId,
    delivery_id: DeliveryId,
    server: ServerUrl = LOCAL_SERVER,
    api_key: ApiKeyText = None,
    retry_within: RetryWithin = DEFAULT_RETRY_WITHIN_S,
    as_json: JsonFlag = False,
) -> None:
    """Send a message anew, under the id that it had."""
    with connected(server, api_key, retry_within) as client:
        delivery = client.webhooks.replay(webhook_id, delivery_id)
    if as_json:
        say_json(delivery.model_dump(mode="json", exclude_none=True))
    else:
        say(_sent(delivery))


def _line(webhook: Webhook) -> str:
    events = ", ".join(webhook.events)
    label = f" {webhook.label!r}" if webhook.label else ""
    why = f", disabled: {webhook.disabled_because}" if webhook.disabled_at else ""
    return f"{webhook.id}  {webhook.url}{label}: {events}{why}"


def _sent(delivery: Delivery) -> str:
    last = delivery.attempts[-1] if delivery.attempts else None
    answer = "not tried yet" if last is None else str(last.status or last.error)
    return (
        f"{delivery.id}  {delivery.state:<9}  {delivery.event}  {delivery.job_id or '-'}  {answer}"
    )
