"""`neuralmri phantom --frames N`: a whole beat of known truth, written."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli.phantom_files import write_phantom
from schemas.vocabulary import Axes, MeshFormat, Structure

if TYPE_CHECKING:
    from worker.phantom import SlicingPlan
    from worker.phantom.beating import BeatingHeart, SlicedBeat

OF_TWO_PHASES = ("radial_shortening", "longitudinal_shortening", "rv_shortening")
"""Numbers of the shape that say how it contracts where no beat does."""


def write_beat(
    out: Path,
    heart: "BeatingHeart",
    count: int,
    plan: "SlicingPlan",
    *,
    edge_mm: float,
    mesh_format: MeshFormat,
    subject_id: str,
) -> dict[str, Any]:
    """Writes a beat of `count` frames into a folder, and returns what truth.json says of it.

    Raises InputError before anything is written.
    """
    from worker.phantom.beating import sliced_beat

    beat = sliced_beat(heart, count, plan, edge_mm=edge_mm, subject_id=subject_id)
    write_phantom(out, beat.frames(), beat.sliced.study, mesh_format)
    _write_trajectories(out / "trajectories.npz", beat)
    truth = {
        "subject_id": subject_id,
        "units": "mm",
        "axes": Axes.LPS.value,
        "shape": {
            name: number
            for name, number in asdict(heart.rest.shape).items()
            if name not in OF_TWO_PHASES
        },
        "beat": asdict(heart.beat) | {"cycle": _cycle(heart)},
        "slicing": asdict(plan),
        "edge_mm": edge_mm,
        "frames": _frames(heart, beat, mesh_format),
        "function": _function(heart),
        "true_shifts_mm": {
            name: shift.round(6).tolist() for name, shift in beat.sliced.true_shifts_mm.items()
        },
    }
    (out / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return truth


def _write_trajectories(path: Path, beat: "SlicedBeat") -> None:
    """By surface, `lv_endo_vertices_mm` (frames, n, 3) and `lv_endo_faces` (m, 3); frame labels
    and times_ms (frames,).
    """
    import numpy as np

    arrays = {"labels": np.array(beat.labels), "times_ms": beat.times_ms}
    for structure, moving in beat.surfaces.items():
        arrays[f"{structure.value}_vertices_mm"] = moving.vertices_mm
        arrays[f"{structure.value}_faces"] = moving.faces
    np.savez(path, allow_pickle=False, **arrays)


def _frames(heart: "BeatingHeart", beat: "SlicedBeat", mesh_format: MeshFormat) -> dict[str, Any]:
    """The truth table: by frame, volumes and the numbers of the motion."""
    import numpy as np

    from worker.evaluation.size import area_cm2, volume_ml
    from worker.phantom.beating.beat import APEX_SHARE

    exact = {name: v.tolist() for name, v in heart.lv_volumes_ml(beat.times_ms).items()}
    cavity_ml, heart_ml = exact[Structure.LV_ENDO], exact[Structure.LV_EPI]
    table = {}
    for i, (label, instant) in enumerate(
        zip(beat.labels, heart.instants(beat.times_ms), strict=True)
    ):
        twist_deg = float(np.degrees(instant.twist_rad))
        surfaces = {
            structure.value: {
                "file": f"{label}_{structure.value}.{mesh_format.value}",
                "volume_ml": volume_ml(moving.frame(i)),
                "closed_form_volume_ml": exact[structure][i] if structure in exact else None,
                "area_cm2": area_cm2(moving.frame(i)),
            }
            for structure, moving in beat.surfaces.items()
        }
        table[label] = {
            "time_ms": float(beat.times_ms[i]),
            "lv_volume_ml": cavity_ml[i],
            "lv_wall_ml": heart_ml[i] - cavity_ml[i],
            "lv_ejected_percent": 100.0 * (1.0 - cavity_ml[i] / cavity_ml[0]),
            "rv_ejected_percent": 100.0 * (1.0 - instant.rv_share),
            "longitudinal_shortening_percent": 100.0 * (1.0 - instant.stretch),
            "twist_deg": twist_deg,
            "apex_rotation_deg": twist_deg * APEX_SHARE,
            "base_rotation_deg": twist_deg * (APEX_SHARE - 1.0),
            "surfaces": surfaces,
        }
    return table


def _cycle(heart: "BeatingHeart") -> dict[str, float]:
    cycle = heart.beat.cycle
    return {
        "heart_rate_bpm": cycle.heart_rate_bpm,
        "duration_ms": cycle.duration_ms,
        "end_systole_ms": cycle.end_systole_ms,
        "filling_ms": cycle.filling_ms,
        "diastasis_ms": cycle.diastasis_ms,
        "kick_ms": cycle.kick_ms,
    }


def _function(heart: "BeatingHeart") -> dict[str, float]:
    """Of the beat itself, whether or not a frame lies at end-systole."""
    import numpy as np

    from worker.evaluation.function import lv_function

    ends_ms = np.array([0.0, heart.beat.cycle.end_systole_ms])
    edv_ml, esv_ml = heart.lv_volumes_ml(ends_ms)[Structure.LV_ENDO].tolist()
    return lv_function(edv_ml, esv_ml).model_dump(exclude_none=True)
