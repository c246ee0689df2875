"""The page of the validation: yes and no where something holds or fails, numbers where there are
numbers.
"""

import numpy as np
import pytest

from evidence.validation.page import validation_page

ROW = {
    "case": "R1",
    "quantity": "slide",
    "reference": 1.0,
    "ours": 0,
    "error": 1.0,
    "tolerance": 2.0,
}


@pytest.mark.parametrize(
    ("holds", "word"),
    [(True, "yes"), ("True", "yes"), (np.True_, "yes"), (False, "no"), ("False", "no")],
)
def test_numbers_stay_numbers_and_booleans_are_words(tmp_path, holds, word):
    page = validation_page([ROW | {"pass": holds}], [], [], tmp_path)
    assert (
        '<td class="number">1</td><td class="number">0</td><td class="number">1</td><td'
        ' class="number">2</td>' in page
    )
    assert (">yes</td>" in page, ">no</td>" in page) == (word == "yes", word == "no")
