"""Label maps on disk."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

from intake.limits import Limits
from schemas.labels import LabelRequest
from schemas.study import ContourStudy
from schemas.vocabulary import View
from tests.labelmaps.nifti_bytes import gz, nifti
from worker.labelmaps.reading import read_label_maps

LIMITS = Limits()
Read = Callable[..., tuple[ContourStudy, list[str]]]


@pytest.fixture
def read(tmp_path: Path) -> Read:
    """Reads maps given as (voxels, affine) by view; `header` goes to the files, other
    keywords to the request."""

    def run(
        maps: Mapping[View, tuple[np.ndarray, np.ndarray]],
        header: Mapping[str, Any] = MappingProxyType({}),
        limits: Limits = LIMITS,
        **fields: Any,
    ) -> tuple[ContourStudy, list[str]]:
        files = {}
        for view, (voxels, affine) in maps.items():
            files[view] = tmp_path / view.value
            files[view].write_bytes(gz(nifti(voxels, affine, **header)))
        request = LabelRequest.model_validate({"subject_id": "s", "label_scheme": "mnms", **fields})
        return read_label_maps(files, request, limits)

    return run
