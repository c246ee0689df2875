"""What makes a completed model worse, and the file in its place."""

from vibroimpact.diagnosis.verdict.misfit import closed_fraction, makes_worse, not_offered

DAMPING = [
    {
        "id": "contact_damping",
        "location": "all",
        "parameters": {"damping": {"value": 1291.0, "unit": "N s/m", "low": 882.0, "high": 1502.0}},
    }
]


def split(before, after, floor=1.2):
    """A misfit of one split."""
    closed = closed_fraction(before, after, floor)
    return {"before_dB": before, "after_dB": after, "floor_dB": floor, "closed_fraction": closed}


def test_file_of_a_withdrawn_model_says_what_was_tried():
    misfit = {"fit": split(9.0, 3.0), "holdout": split(8.9, 10.5)}
    text = not_offered({"effects": DAMPING, "misfit": misfit})
    assert "contact damping" in text and "8.90 dB before and 10.50 dB after" in text
    assert all(line.startswith("#") for line in text.splitlines())


def test_file_says_which_records_a_model_makes_worse():
    misfit = {"fit": split(5.6, 8.1), "holdout": split(3.1, 2.4)}
    text = not_offered({"effects": DAMPING, "misfit": misfit})
    assert "fitted to" in text and "5.60 dB before and 8.10 dB after" in text
    misfit = {"fit": split(9.0, 3.0), "holdout": split(3.1, 3.0)}
    assert "still off" in not_offered({"effects": DAMPING, "misfit": misfit})


def test_what_is_left_within_chance_is_no_growth():
    assert makes_worse(split(8.9, 10.5)) and not makes_worse(split(8.9, 8.8))
    assert not makes_worse(split(1.25, 1.3)) and makes_worse(split(1.25, 2.0))
    assert not makes_worse(split(2.23, 2.25, 1.52))  # beyond the floor, and no more than before
    assert not makes_worse({"before_dB": None, "after_dB": None, "floor_dB": None})
