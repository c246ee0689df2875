"""How many seconds of a record are screened and compared."""

import pytest

from vibroimpact.discrepancy.windows import compared_s, screened_s


@pytest.mark.parametrize(
    ("records", "duration", "asked", "expected"),
    [
        (4, 49.0, None, 24.0),
        (8, 49.0, None, 24.0),
        (9, 49.0, None, 12.0),
        (40, 49.0, None, 12.0),
        (4, 20.0, None, 20.0),
        (4, 8.0, None, 8.0),
        (4, 49.0, 40.0, 40.0),
        (4, 20.0, 49.0, 20.0),
    ],
)
def test_the_length_compared_follows_the_batch_and_the_request(records, duration, asked, expected):
    compared = compared_s(records, duration, asked)
    assert compared == expected
    assert screened_s(compared) == min(expected, 12.0)
