"""Whatever passes the schema is admitted or refused with a problem, never an exception of numpy."""

from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from intake.study import admit
from schemas.options import Options
from schemas.problem import InputError
from schemas.study import ContourStudy

# Few distinct values, so that points coincide, align and cross often; and the extremes.
ordinary = st.integers(-3, 3).map(lambda v: 20.0 * v)
extreme = st.sampled_from([0.0, 5e-324, 1e-300, 1e-9, 1e-3, -1e7, 1e7, 33.3])
coordinates = st.one_of(ordinary, ordinary, ordinary, extreme)


def slices(values: st.SearchStrategy[float]) -> st.SearchStrategy[dict[str, Any]]:
    points = st.tuples(values, values, values)
    flat = st.tuples(values, values, st.just(0.0))
    contours = st.fixed_dictionaries(
        {
            "structure": st.sampled_from(["lv_endo", "lv_epi", "rv_endo", "epi"]),
            "closed": st.booleans(),
            "points": st.one_of(
                st.lists(points, min_size=3, max_size=8), st.lists(flat, min_size=3, max_size=12)
            ),
        }
    )
    plane = st.one_of(
        st.just({}),
        st.just({"origin": (0.0, 0.0, 0.0), "normal": (0.0, 0.0, 1.0)}),
        st.fixed_dictionaries({"origin": points, "normal": points.filter(any)}),
    )
    return st.builds(
        lambda c, p: {"contours": c, **p}, st.lists(contours, min_size=1, max_size=4), plane
    )


def judged(found: list[dict[str, Any]], units: str) -> None:
    numbered = [{"id": f"s{k}", **s} for k, s in enumerate(found)]
    study = ContourStudy.model_validate(
        {
            "subject_id": "a",
            "units": units,
            "axes": "LPS",
            "frames": [{"label": "ED", "slices": numbered}],
        }
    )
    assert all(said.endswith(".") for said in verdict(study))


def verdict(study: ContourStudy) -> list[str]:
    """The warnings, or the refusal: whatever else is raised fails the test."""
    try:
        return admit(study, Options())
    except InputError as error:
        return [error.detail]


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(slices(coordinates), min_size=1, max_size=4), st.sampled_from(["mm", "m", "um"]))
def test_any_study(found: list[dict[str, Any]], units: str) -> None:
    judged(found, units)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(slices(ordinary), min_size=1, max_size=4))
def test_any_study_the_size_of_a_heart(found: list[dict[str, Any]]) -> None:
    judged(found, "mm")
