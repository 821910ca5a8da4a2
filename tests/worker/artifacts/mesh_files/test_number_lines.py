import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from worker.artifacts.mesh_files.number_lines import number_lines

tables = st.integers(0, 6).flatmap(
    lambda rows: arrays(
        np.int64,
        (rows, 3),
        elements=st.one_of(st.integers(-120, 120), st.integers(-(10**12), 10**12)),
    )
)


@pytest.mark.parametrize("decimals", [0, 1, 6])
@settings(deadline=None)
@given(table=tables)
def test_as_each_number_alone_is_written(table, decimals):
    expected = "".join(
        "v " + " ".join(f"{x / 10**decimals:.{decimals}f}" for x in row) + "\n"
        for row in table.tolist()
    )
    assert number_lines("v", table, decimals) == expected.encode("ascii")
