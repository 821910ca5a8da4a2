"""Who takes part: this project's presets and their classical peers, named honestly.

All but ITK's are written in `worker/interpolation`, after the papers that they name.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Method:
    """One competitor.

    name: as chosen on the command line and kept in the results. entry: `module:function` from a
    study to a `Found`; a child process loads that module and no other method's. label: as shown.
    after: whose method it is, and by whom it was written down here. evidence: which slices it uses.
    """

    name: str
    entry: str
    label: str
    after: str
    evidence: str


_ALL = "all slices"
_STACK = "short-axis slices only: the method knows parallel planes"

METHODS = (
    Method(
        "field-fast",
        "benchmarks.by_field:fast",
        "field, fast",
        "this project, `preset: fast`",
        _ALL,
    ),
    Method(
        "field-standard",
        "benchmarks.by_field:standard",
        "field, standard",
        "this project, its default",
        _ALL,
    ),
    Method(
        "field-unaligned",
        "benchmarks.by_field:unaligned",
        "field, unaligned",
        "this project, standard with `align_slices: false`",
        _ALL,
    ),
    Method(
        "field-paper",
        "benchmarks.by_field:paper",
        "field, paper",
        "this project, `preset: paper`: nearest to the published recipe, no slice alignment",
        _ALL,
    ),
    Method(
        "hermite-rbf",
        "benchmarks.by_interpolation:by_hermite_rbf",
        "Hermite RBF",
        "radial basis functions, Carr et al., SIGGRAPH 2001: cubic, one dense solve; smoothed by "
        "how far crossing slices disagree",
        _ALL,
    ),
    Method(
        "hermite-rbf-refined",
        "benchmarks.by_interpolation:by_hermite_rbf_refined",
        "Hermite RBF, refined",
        "our own refinement of it: values by how the surface leans, three solves, sides known from "
        "slices",
        _ALL,
    ),
    Method(
        "shape-linear",
        "benchmarks.by_interpolation:by_shape_linear",
        "shape-based, linear",
        "shape-based interpolation, Raya and Udupa, IEEE TMI 9(1), 1990",
        _STACK,
    ),
    Method(
        "shape-cubic",
        "benchmarks.by_interpolation:by_shape_cubic",
        "shape-based, cubic",
        "the same with cubic splines, Herman et al., IEEE CG&A 12(3), 1992; here Akima's, JACM "
        "17(4), 1970",
        _STACK,
    ),
    Method(
        "lofting",
        "benchmarks.by_interpolation:by_lofting",
        "lofting",
        "cubic splines through corresponding points of the outlines",
        _STACK,
    ),
    Method(
        "morphological",
        "benchmarks.by_itk:by_morphological",
        "morphological",
        "ITK's morphological contour interpolation, by dilation: Albu et al., IEEE TBME 55(8), "
        "2008; Zukic et al., Insight Journal 2016",
        _STACK,
    ),
)
"""In the order of the tables."""

OURS = "field-standard"
UNALIGNED = "field-unaligned"
RIVALS = ("hermite-rbf", "hermite-rbf-refined")
"""The peers that ratios are taken against, the published one first: they too use all slices."""

BY_NAME = {method.name: method for method in METHODS}


def chosen(names: tuple[str, ...]) -> tuple[Method, ...]:
    """The named methods in the order of the tables; all when none is named.

    Raises ValueError for a name that is none.
    """
    unknown = set(names) - set(BY_NAME)
    if unknown:
        raise ValueError(
            f"there is no method {', '.join(sorted(unknown))}; choose from {', '.join(BY_NAME)}"
        )
    return tuple(m for m in METHODS if not names or m.name in names)
