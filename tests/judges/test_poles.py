"""sdypy-EMA, pyOMA2 and scipy judge poles and spectra."""

import pytest

from evidence.validation.judges.poles import pyoma_checks, sdypy_checks, spectrum_checks
from evidence.validation.judges.presence import JudgeAbsent

# What these packages and theirs warn of at import or at poles they throw away themselves.
pytestmark = pytest.mark.filterwarnings(
    "ignore::DeprecationWarning",
    "ignore::SyntaxWarning",
    "ignore::FutureWarning",
    "ignore::RuntimeWarning",
)


@pytest.mark.parametrize("judge", [sdypy_checks, pyoma_checks, spectrum_checks])
def test_every_check_passes(study_model, judge):
    try:
        checks = judge(study_model)
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    assert [check.quantity for check in checks if not check.passed] == [] and len(checks) >= 4
