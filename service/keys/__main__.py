"""`python -m service.keys` where the command line is not installed, as in the service's image.

The same as `neuralmri keys`, on the data folder of the environment, and always in JSON.
"""

import argparse
import json
import sys
from typing import Any

from schemas.api_key import Scope
from schemas.problem import ServiceError
from service.keys.desk import KeyDesk
from service.keys.duration import duration
from service.settings import ServiceSettings


def main(arguments: list[str]) -> int:
    """Exit code: 0, or 2 for a request that cannot be met."""
    given = _parser().parse_args(arguments)
    try:
        document = _done(given, KeyDesk(ServiceSettings()))
    except ServiceError as error:
        json.dump(error.problem().model_dump(mode="json", exclude_none=True), sys.stdout)
        return 2
    json.dump(document, sys.stdout, indent=1)
    sys.stdout.write("\n")
    return 0


def _done(given: argparse.Namespace, desk: KeyDesk) -> Any:
    match given.command:
        case "create":
            lifetime = duration(given.expires) if given.expires else None
            made = desk.create(given.label, given.owner, tuple(given.scope), lifetime)
            return made.model_dump(mode="json")
        case "rotate":
            return desk.rotate(given.id, duration(given.overlap)).model_dump(mode="json")
        case "revoke":
            return desk.revoke(given.id).model_dump(mode="json")
    return {"keys": [listed.model_dump(mode="json") for listed in desk.listed()]}


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m service.keys")
    commands = parser.add_subparsers(dest="command", required=True)
    create = commands.add_parser("create")
    create.add_argument("--label", required=True)
    create.add_argument("--scope", type=Scope, action="append", required=True)
    create.add_argument("--owner")
    create.add_argument("--expires")
    rotate = commands.add_parser("rotate")
    rotate.add_argument("id")
    rotate.add_argument("--overlap", default="7d")
    commands.add_parser("revoke").add_argument("id")
    commands.add_parser("list")
    return parser


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
