"""R1 to R6 through the public interface, from their configurations alone, and the order of the
integrator.
"""

from pathlib import Path

import numpy as np
import pytest

from evidence.validation.reference.runs import impact_checks

FOLDER = Path(__file__).resolve().parents[2] / "config" / "reference"


@pytest.fixture(scope="module")
def impacts():
    """The checks and the order's rows, run once."""
    return impact_checks(FOLDER)


@pytest.mark.parametrize("case", ["R1", "R2", "R3", "R4", "R5", "R6"])
def test_reference_case(impacts, case):
    checks = [check for check in impacts[0] if check.case == case]
    assert len(checks) == {"R1": 5, "R2": 7, "R3": 24, "R4": 6, "R5": 4, "R6": 5}[case]
    assert [check.row() for check in checks if not check.passed] == []


def test_contact_times_fall_with_the_square_of_the_step(impacts):
    rows = impacts[1]
    assert all(
        before["contact_time_error_s"] > 2.0 * after["contact_time_error_s"]
        for before, after in zip(rows[:-1], rows[1:], strict=True)
    )
    assert np.log2(
        rows[0]["contact_time_error_s"] / rows[-1]["contact_time_error_s"]
    ) == pytest.approx(6.0, abs=1.0)  # three halvings
