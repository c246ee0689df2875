"""F9 and F10: the depth of wear from a work rate and a time.

F9 is a test of code_aster (zzzz405a): 0.5 W on a tube of 1 m radius over 10 m.
"""

import numpy as np

from evidence.validation.check import Check
from vibroimpact.config.wear import Wear
from vibroimpact.study.wear.laws import (
    YEAR_S,
    Archard,
    EdfMz,
    WearLaw,
    WornShape,
    depth_of,
    volume_of,
)
from vibroimpact.study.wear.life import worn_life

ASTER = "code_aster (zzzz405a)"
EXACT, POWER_W = "closed form", 0.5
MONTHS_S, DAYS_S = 12.0 * 2.628e6, 730.0 * 86400.0  # the years of code_aster


def wear_checks() -> list[Check]:
    """Return the Checks of F9 and F10.

    The exact segment of F10 is 0.4 % deeper than the shallow one of code_aster's formula.
    """
    flat, tilted = WornShape(10.0, 1.0), WornShape(10.0, 1.0, tilt=np.deg2rad(1.0))
    bore = WornShape(20.0, 1.0, bore=2.0)  # code_aster takes 2 L A
    plain, volume = WornShape(0.012, 0.01111), 20.0e-15 * 1.0e-3 * 40.0 * YEAR_S
    checks = [
        Check(
            "F9", f"depth, {name}", "m", expected, ASTER, _depth(law, time, shape, expected), 2e-3
        )
        for name, expected, law, time, shape in (
            ("flat bar, EDF_MZ", 1.770377e-5, EdfMz(), DAYS_S, flat),
            ("bar tilted by 1 deg", 3.675864e-4, Archard(7.1e-15), MONTHS_S, tilted),
            ("bore of 2 m radius", 9.564534e-4, Archard(1.0e-10), MONTHS_S, bore),
        )
    ]
    deep, worn = (
        1e6 * depth_of(volume, plain),
        1e9 * float(volume_of(depth_of(volume, plain), plain)),
    )
    return [
        *checks,
        Check("F10", "volume after 40 years", "mm3", 25.246, EXACT, worn, 2e-3),
        Check("F10", "depth, exact segment", "um", 484.2, EXACT, deep, 2e-3),
        Check("F10", "depth", "um", 482.1, "code_aster's formula, shallow segment", deep, 5e-3),
    ]


def _depth(law: WearLaw, seconds: float, shape: WornShape, expected: float) -> float:
    """Return the depth in m after a time under POWER_W; expected: m, which sets the steps."""
    years = Wear(years=seconds / YEAR_S)
    return worn_life(law, np.vectorize(lambda _: POWER_W), shape, 2.0 * expected, years)[1]
