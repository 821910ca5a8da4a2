import pytest

from worker.phantom.beating import PRESETS, BeatingHeart, BeatPreset


@pytest.fixture(scope="session", params=list(BeatPreset))
def beating(request):
    """Each preset's heart in turn."""
    case = PRESETS[request.param]
    return BeatingHeart(case.shape, case.beat)


@pytest.fixture(scope="session")
def healthy():
    return BeatingHeart()


@pytest.fixture(scope="session")
def infarcted():
    case = PRESETS[BeatPreset.INFARCT]
    return BeatingHeart(case.shape, case.beat)
