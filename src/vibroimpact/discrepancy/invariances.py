"""The invariance lights: which exact properties of the bare model the measurement breaks."""

import numpy as np

from . import priors

PARITY_Z, MIRROR_Z, SCALING_DB = 3.5, 4.0, 1.0


def broken_invariances(bench, null, prepared, power=False):
    """Return [T1, ...]: the tests that fail beyond the seeds' scatter. T1 linearity below contact,
    T2 scaling, T3 parity, T4 mirror, T5 power balance (power: see power_balance.broken), T6
    stationarity.
    """
    layout, measured = bench.layout, bench.measured_features[null.records]
    spread = np.sqrt(
        null.seed_variance * (1.0 + 1.0 / null.seeds)
        + np.array([priors.FEATURE_SD[kind] for kind in layout.kind]) ** 2
    )
    z = (measured - null.mean) / spread
    out = []
    if prepared.adopted is not None or prepared.nonlinear_low:
        out.append("T1")
    if _scaling(bench, null, measured) > SCALING_DB:
        out.append("T2")
    if np.abs(z[:, layout.kind == "skewness"]).max(initial=0.0) > PARITY_Z:
        out.append("T3")
    if np.abs(z[:, (layout.kind == "co") | (layout.kind == "quad")]).max(initial=0.0) > MIRROR_Z:
        out.append("T4")
    if power:
        out.append("T5")
    if any(row["check"] == "stationarity" and row["level"] != "pass" for row in prepared.checks):
        out.append("T6")
    return out


def _scaling(bench, null, measured):
    """Return the RMS in dB by which D differs between records of one load and different gaps: q/gap
    no longer depends on F/gap alone.
    """
    difference = bench.layout.power(measured - null.mean)
    load, gap = np.round(bench.signals.load[null.records], 3), bench.signals.gap[null.records]
    worst = 0.0
    for one in range(len(load)):
        for other in range(one + 1, len(load)):
            if (
                abs(load[one] / load[other] - 1.0) < 0.05
                and abs(gap[one] / gap[other] - 1.0) > 0.05
            ):
                own = np.mean(
                    null.seed_variance[[one, other]].sum(axis=0)[bench.layout.kind == "power"]
                )
                worst = max(
                    worst,
                    np.sqrt(max(0.0, np.mean((difference[one] - difference[other]) ** 2) - own)),
                )
    return float(worst)
