"""The exact properties of the bare model that the measurement breaks."""

from typing import Any

import numpy as np
from scipy import stats

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.prepared import Prepared
from vibroimpact.linear_stage.workbench import Workbench

from .null_like import NullLike

MIRROR_Z, SCALING_DB = 4.0, 1.0


def broken_invariances(
    bench: Workbench, null: NullLike, prepared: Prepared, power: bool = False
) -> list[str]:
    """Return [T1, ...]: the tests that fail beyond the scatter of the seeds.

    T1 linearity below contact, T2 scaling, T3 parity, T4 mirror, T5 power balance (power: see
    power_balance.broken), T6 stationarity.
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
    if one_sided(bench, null, measured, null.mean) is not None:
        out.append("T3")
    if np.abs(z[:, (layout.kind == "co") | (layout.kind == "quad")]).max(initial=0.0) > MIRROR_Z:
        out.append("T4")
    if power:
        out.append("T5")
    if any(row["check"] == "stationarity" and row["level"] != "pass" for row in prepared.checks):
        out.append("T6")
    return out


def one_sided(
    bench: Workbench, null: NullLike, measured: np.ndarray, mean: np.ndarray
) -> tuple[int, int, float] | None:
    """Return (record, channel, z) of the skewness that differs most from the model, None where no
    difference is significant.

    measured, mean (record, feature): of the measurement and of the model. Where every law of a
    model is odd (round holes, centred, no dead load), responses to a force without skewness have
    none. z is in standard deviations and follows a t law of the seeds; the significance level of
    the largest of all is priors.SIGNIFICANT.
    """
    layout = bench.layout
    chosen = layout.kind == "skewness"
    variance = null.seed_variance * (1.0 + 1.0 / null.seeds) + priors.FEATURE_SD["skewness"] ** 2
    z = ((measured - mean) / np.sqrt(variance))[:, chosen]
    record, channel = np.unravel_index(np.argmax(np.abs(z)), z.shape)
    largest = float(z[record, channel])
    if 2.0 * stats.t.sf(abs(largest), null.seeds - 1) * z.size > priors.SIGNIFICANT:
        return None
    return int(record), int(layout.channel[chosen][channel]), largest


def one_sided_rows(
    bench: Workbench, null: NullLike, measured: np.ndarray, completed: np.ndarray
) -> list[dict[str, Any]]:
    """Return a row of checks on whether the completed model has the skewness of the measurement.

    No row where the bare model has it. measured, completed (record, feature): of the measurement
    and mean of the completed model.
    """
    before = one_sided(bench, null, measured, null.mean)
    if before is None:
        return []
    after = one_sided(bench, null, measured, completed)
    record, channel, z = before if after is None else after
    name = bench.signals.record_names[null.records[record]]
    seen = f"The response of {bench.signals.names[channel]} in record {name} is lopsided"
    if after is None:
        return [
            check_row(
                "symmetry",
                "pass",
                f"{seen} (z = {z:.1f}); so is that of the completed model.",
                name,
                bench.signals.names[channel],
            )
        ]
    return [
        check_row(
            "symmetry",
            "warn",
            f"{seen} (z = {z:.1f}), and that of the model with what is told is not so: something"
            " acts on one side, a stop, a dead load or a support off its centre, whatever else is"
            " missing.",
            name,
            bench.signals.names[channel],
        )
    ]


def _scaling(bench, null, measured):
    """Return the largest RMS in dB by which D differs between records of one load and different
    gaps, where it should depend on force over gap alone.
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
