"""Numbers in --config NAME=NUMBER, in addition to the keys of the study."""

import math

MOST = 1e15  # of whole numbers: below it every one is exact as a float


def asked_number(name: str, text: str, example: str, whole: bool = False) -> float:
    """Return the positive number that a text states; with `whole`, a whole number from 0 on.

    Raises ValueError with a sentence.
    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if whole and 0 <= value <= MOST and value == math.floor(value):
        return value
    if not whole and 0 < value < math.inf:
        return value
    what = "a whole number" if whole else "a positive number"
    raise ValueError(f"{name} = '{text}': give {what}, as in --config {name}={example}")
