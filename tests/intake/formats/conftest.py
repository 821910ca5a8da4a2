import pytest

from schemas.study import ContourStudy
from worker.phantom.standard_study import ONE_BEAT, standard_study


@pytest.fixture(scope="session")
def beat() -> ContourStudy:
    """The phantom's outlines at ED and ES: a stack and three long-axis planes."""
    return standard_study(ONE_BEAT, edge_mm=2.0)
