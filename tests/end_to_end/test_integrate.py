"""docs/integrate.md, as an integrator would take it: every transcript and program, for real."""

import base64
import json
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.end_to_end.serve_process import ServeProcess
from tests.end_to_end.transcript import programs
from tests.end_to_end.typed_in import ROOT, run_program, type_in

pytestmark = [pytest.mark.integration, pytest.mark.slow]

GUIDE = ROOT / "docs" / "integrate.md"
ROI_NAMES = {"lv_endo": "LV Endocardium", "lv_epi": "LV Epicardium", "rv_endo": "RV Endocardium"}


def test_the_transcripts_can_be_typed_in(server: ServeProcess, tmp_path: Path) -> None:
    type_in(GUIDE, server, tmp_path)


def test_every_program_is_run_here() -> None:
    assert len(programs(GUIDE.read_text())) == 2


def test_the_client_keeps_its_files_and_leaves_no_job(server: ServeProcess, tmp_path: Path) -> None:
    before = job_ids(server)
    printed = run_program(GUIDE, 0, server, tmp_path)
    assert "LV cavity, mL: 11" in printed
    assert (tmp_path / "case-01" / "ED_lv_endo.stl").stat().st_size > 1000
    assert job_ids(server) == before


def test_an_rt_structure_set_becomes_a_transaction(server: ServeProcess, tmp_path: Path) -> None:
    study = json.loads((ROOT / "examples" / "contours.json").read_text())["study"]
    (tmp_path / "rtstruct.json").write_text(json.dumps([rtstruct_of(study)]))
    run_program(GUIDE, 1, server, tmp_path)
    bundle = json.loads((tmp_path / "bundle.json").read_text())
    resources = [entry["resource"] for entry in bundle["entry"]]
    documents = [one for one in resources if one["resourceType"] == "DocumentReference"]
    observations = [one for one in resources if one["resourceType"] == "Observation"]
    assert len(documents) == len(observations) == 3
    mesh = base64.b64decode(documents[0]["content"][0]["attachment"]["data"])
    assert len(mesh) == 84 + 50 * int.from_bytes(mesh[80:84], "little")
    (cavity,) = [o for o in observations if o["code"]["text"] == "Volume within lv_endo at ED"]
    assert 105.0 < cavity["valueQuantity"]["value"] < 130.0


def job_ids(server: ServeProcess) -> list[str]:
    return [job["id"] for job in httpx.get(f"{server.url}/v1/jobs").json()["jobs"]]


def rtstruct_of(study: dict[str, Any]) -> dict[str, Any]:
    """The study's contours as a DICOMweb server would give them."""

    def element(vr: str, *values: Any) -> dict[str, Any]:
        return {"vr": vr, "Value": list(values)}

    def contour(number: int, outline: dict[str, Any]) -> dict[str, Any]:
        kind = "CLOSED_PLANAR" if outline["closed"] else "OPEN_PLANAR"
        return {
            "30060016": element("SQ", {"00081155": element("UI", f"1.2.826.0.1.{number}")}),
            "30060042": element("CS", kind),
            "30060050": element("DS", *[x for point in outline["points"] for x in point]),
        }

    slices = study["frames"][0]["slices"]
    return {
        "30060020": element(
            "SQ",
            *[
                {"30060022": element("IS", number), "30060026": element("LO", name)}
                for number, name in enumerate([*ROI_NAMES.values(), "Liver"])
            ],
        ),
        "30060039": element(
            "SQ",
            *[
                {
                    "30060084": element("IS", number),
                    "30060040": element(
                        "SQ",
                        *[
                            contour(place, outline)
                            for place, one in enumerate(slices)
                            for outline in one["contours"]
                            if outline["structure"] == structure
                        ],
                    ),
                }
                for number, structure in enumerate(ROI_NAMES)
            ],
            {"30060084": element("IS", 3), "30060040": element("SQ", {})},
        ),
    }
