"""How much is spent on a verdict: one dial on one path."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Effort:
    """compared_s: of every record that is compared; rounds: of the race, at most; width:
    explanations in a round; pairs: second effects that are tried beside each leading one, and
    explanations that are looked at more widely where nothing explains; steps: of all modes of
    the simulated records of the search, in time, beyond which nothing more is run.
    """

    compared_s: float
    rounds: int
    width: int
    pairs: int
    steps: float = np.inf


EFFORTS = {
    "quick": Effort(10.0, 1, 3, 0, 0.4e11),
    "standard": Effort(16.0, 4, 3, 6, 1.2e11),
    "thorough": Effort(30.0, 8, 6, 12),
}
