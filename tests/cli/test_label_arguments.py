"""The options of label maps are the same wherever they are taken."""

from dataclasses import fields
from pathlib import Path
from typing import Annotated

import pytest
import typer
from typer.main import get_command
from typer.testing import CliRunner

from cli.label_arguments import LabelArguments, takes_label_maps
from cli.main import app
from schemas.labels import Spacing
from schemas.vocabulary import View

FIELDS = {field.name for field in fields(LabelArguments)}


@pytest.mark.parametrize("name", ["ablate", "reconstruct", "submit", "rerun"])
def test_every_command_takes_them(name: str) -> None:
    command = get_command(app).commands[name]  # type: ignore[attr-defined]
    taken = {parameter.name for parameter in command.params}
    assert taken & FIELDS == FIELDS - ({"subject_id"} if name == "rerun" else set())
    assert "maps" not in taken


def test_what_was_typed_arrives_beside_a_commands_own(tmp_path: Path) -> None:
    arrived = []
    small = typer.Typer()

    @small.command()
    @takes_label_maps(without=("subject_id",))
    def command(
        study: Annotated[str, typer.Argument()],
        *,
        maps: LabelArguments,
        level: Annotated[int, typer.Option()] = 3,
    ) -> None:
        arrived.append((study, maps, level))

    file = tmp_path / "sax.nii"
    file.touch()
    runner = CliRunner()
    given = ["x", "--sax", str(file), "--spacing", "affine", "--level", "4"]
    assert runner.invoke(small, given).exit_code == 0
    assert runner.invoke(small, ["y"]).exit_code == 0
    (_, maps, _), plain = arrived
    assert arrived[0] == ("x", LabelArguments(sax=file, spacing=Spacing.AFFINE), 4)
    assert maps.files == {View.SAX: file}
    assert plain == ("y", LabelArguments(), 3)
    assert runner.invoke(small, ["z", "--subject-id", "s"]).exit_code == 2
