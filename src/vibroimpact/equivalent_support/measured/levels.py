"""The cases of a campaign: records of one gap and about one level are the seeds of a case.

The level of a record is the RMS of its force in N. If no record has one it is the RMS of the
displacement in m, so that records still differ by the strength of the motion.
"""

from collections.abc import Sequence

import numpy as np

from vibroimpact.study.cases import Case

# Largest ratio of two levels of one case. Responses of one level scatter more than its forces.
SAME_LOAD, SAME_RESPONSE = 1.05, 1.25
DIGITS = 4


def cases_of_records(level: np.ndarray, gap_m: np.ndarray, same: float = SAME_LOAD) -> list[Case]:
    """Return the Case of each record.

    level: (record,) RMS of the force in N, or of the displacement in m.
    gap_m: (record,) radial gap in m.
    same: largest ratio of two levels of one case.
    """
    found: dict[int, Case] = {}
    for gap in np.unique(gap_m):
        for together in _alike(level, np.flatnonzero(gap_m == gap), same):
            middle = float(f"{np.mean(level[together]):.{DIGITS}g}")
            for seed, record in enumerate(sorted(together)):
                found[record] = Case(middle, float(gap), seed)
    return [found[record] for record in range(len(level))]


def _alike(level: np.ndarray, records: Sequence[int] | np.ndarray, same: float) -> list[list[int]]:
    """Return the records of each level, ascending."""
    groups: list[list[int]] = []
    for record in sorted(map(int, records), key=lambda record: level[record]):
        if groups and level[record] <= same * level[groups[-1][0]]:
            groups[-1].append(record)
        else:
            groups.append([record])
    return groups


def gaps_of_records(stated_m: np.ndarray, model_m: Sequence[float]) -> np.ndarray:
    """Return (record,) gaps in m: as stated, else the largest of the model's grid.

    stated_m: (record,) m, NaN if a record states none.
    model_m: gaps of the model's grid.
    """
    known = np.isfinite(stated_m) & (stated_m > 0.0)
    return np.where(known, stated_m, max(model_m))
