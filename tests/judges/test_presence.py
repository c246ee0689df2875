"""A judge that is not installed says so in a sentence, and the rest goes on."""

import sys

import pytest

from evidence.validation.figures.judges import judged_impacts
from evidence.validation.judges import presence as judges_presence
from evidence.validation.judges import table as judges
from evidence.validation.judges.presence import JudgeAbsent


@pytest.fixture
def nothing_installed(monkeypatch):
    """No judge but scipy."""
    for name in ("openseespy", "openseespy.opensees", "sdypy", "pyoma2", "pyoma2.functions"):
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setattr(judges_presence.shutil, "which", lambda _: None)


@pytest.mark.parametrize(
    "judge, remedy",
    [
        (judges_presence.opensees, "requirements-judges.lock"),
        (judges_presence.sdypy_ema, "requirements-judges.lock"),
        (judges_presence.pyoma2, "requirements-judges.lock"),
        (lambda: judges_presence.calculix(""), "apt-get"),
    ],
)
def test_the_sentence_names_the_remedy(nothing_installed, judge, remedy):
    with pytest.raises(JudgeAbsent, match=remedy):
        judge()


def test_study_runs_without_external_solvers(nothing_installed, study_config, tmp_path):
    verdicts = judges.all_verdicts(study_config)
    assert {check.case for check in verdicts.checks} == {"judge scipy"} and all(
        check.passed for check in verdicts.checks
    )
    assert len(verdicts.absent) == 4 and verdicts.presence().count("Absent: ") == 4
    judged_impacts(verdicts, 1.0e-4).save(tmp_path)
    assert "OpenSees" in (tmp_path / "validation_judges.txt").read_text()


def test_calculix_error_is_reported():
    try:
        with pytest.raises(RuntimeError, match="ccx ended"):
            judges_presence.calculix("*STEP\n*FREQUENCY\n")
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
