"""`neuralmri keys create | list | revoke | rotate`: who may call the service."""

from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import notice_console, say, say_json
from cli.input_arguments import JsonFlag
from schemas.api_key import ApiKey, ListedKey, MadeKey, Scope

if TYPE_CHECKING:
    from service.keys.desk import KeyDesk

keys = typer.Typer(
    name="keys",
    help="Make, list and call back the API keys of a service; it need not run.",
    no_args_is_help=True,
)

DataDir = Annotated[
    Path,
    typer.Option(envvar="NEURALMRI_DATA_DIR", help="Where the service keeps its data."),
]
KeyIdArgument = Annotated[str, typer.Argument(metavar="ID", help="As `keys list` shows it.")]


@keys.command()
def create(
    label: Annotated[str, typer.Option(help="What the key is for.")],
    scope: Annotated[list[Scope], typer.Option(help="What it may do; once for each.")],
    owner: Annotated[
        str | None, typer.Option(help="Whose jobs it works on.  [default: the label]")
    ] = None,
    expires: Annotated[
        str | None, typer.Option(help="How long it is good: 90d, 12h.  [default: for ever]")
    ] = None,
    data_dir: DataDir = Path("data"),
    as_json: JsonFlag = False,
) -> None:
    """Make a key and show it, this once."""
    from service.keys.duration import duration

    lifetime = duration(expires) if expires is not None else None
    _show_made(_desk(data_dir).create(label, owner, tuple(scope), lifetime), as_json)


@keys.command("list")
def list_(data_dir: DataDir = Path("data"), as_json: JsonFlag = False) -> None:
    """Every key: whose, for what, until when, last used when. Never the secret."""
    found = _desk(data_dir).listed()
    if as_json:
        say_json({"keys": [listed.model_dump(mode="json") for listed in found]})
        return
    for listed in found:
        say(_line(listed))
    if not found:
        notice_console.print("There is no key: the service asks for none.")


@keys.command()
def revoke(
    key_id: KeyIdArgument, data_dir: DataDir = Path("data"), as_json: JsonFlag = False
) -> None:
    """Call a key back: it opens nothing from now on, also where the service runs."""
    revoked = _desk(data_dir).revoke(key_id)
    if as_json:
        say_json(revoked.model_dump(mode="json"))
    else:
        say(_line(revoked))


@keys.command()
def rotate(
    key_id: KeyIdArgument,
    overlap: Annotated[str, typer.Option(help="How long the old key is still good.")] = "7d",
    data_dir: DataDir = Path("data"),
    as_json: JsonFlag = False,
) -> None:
    """Make a key of the same owner, label, scopes and lifetime in the place of another."""
    from service.keys.duration import duration

    _show_made(_desk(data_dir).rotate(key_id, duration(overlap)), as_json)


def _desk(data_dir: Path) -> "KeyDesk":
    from service.keys.desk import KeyDesk
    from service.settings import ServiceSettings

    return KeyDesk(ServiceSettings(data_dir=data_dir))


def _show_made(made: MadeKey, as_json: bool) -> None:
    if as_json:
        say_json(made.model_dump(mode="json"))
        return
    notice_console.print(f"{_said(made.key)}; it is shown only now:", markup=False, soft_wrap=True)
    say(made.token)


def _said(key: ApiKey) -> str:
    until = f"until {_minute(key.expires_at)}" if key.expires_at else "for ever"
    return f"{key.id} {key.label!r} of {key.owner}: {', '.join(key.scopes)}, {until}"


def _line(listed: ListedKey) -> str:
    used = listed.last_used_at
    last = f"last used {_minute(used)}" if used else "never used"
    return f"{_said(listed.key)}, {listed.state}, {last}"


def _minute(instant: datetime) -> str:
    return instant.isoformat(timespec="minutes")
