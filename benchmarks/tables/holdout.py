"""Leave-one-slice-out errors beside the true ones: ratio and correlation."""

import numpy as np
from scipy.stats import pearsonr, spearmanr

from benchmarks.holdout_results import HoldoutResults, SurfaceRow
from benchmarks.tables.markdown import number, table


def by_surface(results: HoldoutResults) -> str:
    """Every surface of every case."""
    rows = [
        (
            row.case,
            row.surface,
            f"{row.slices}",
            number(row.held_out_mm, 2),
            number(row.true_mm, 2),
            number(row.held_out_mm / row.true_mm, 1),
        )
        for row in results.surfaces
    ]
    header = ("case", "surface", "slices", "left out, mm", "true, mm", "ratio")
    return table(header, rows)


def in_short(results: HoldoutResults) -> str:
    """Correlations and ratios over all surfaces, phantoms and anatomy apart, and over slices."""
    groups: dict[str, list[SurfaceRow]] = {
        "surfaces of phantoms": [r for r in results.surfaces if r.case.startswith("phantom")],
        "surfaces of anatomy": [r for r in results.surfaces if not r.case.startswith("phantom")],
        "all surfaces": list(results.surfaces),
    }
    pairs = {
        name: np.array([(r.held_out_mm, r.true_mm) for r in rows]).reshape(-1, 2)
        for name, rows in groups.items()
    }
    pairs["all slices"] = np.array(
        [(one.held_out_mm, one.true_mm) for r in results.surfaces for one in r.by_slice]
    ).reshape(-1, 2)
    header = ("over", "number", "correlation", "rank correlation", "ratio: median", "10 %", "90 %")
    return table(header, [(name, *_numbers(pair)) for name, pair in pairs.items()])


def _numbers(pairs: np.ndarray) -> list[str]:
    if len(pairs) < 3:
        return [f"{len(pairs)}", *["-"] * 5]
    ratios = pairs[:, 0] / pairs[:, 1]
    # Of logarithms: errors of different cases differ by factors.
    return [
        f"{len(pairs)}",
        number(float(pearsonr(*np.log(pairs).T).statistic), 2),
        number(float(spearmanr(*pairs.T).statistic), 2),
        *(number(float(np.percentile(ratios, at)), 1) for at in (50, 10, 90)),
    ]
