"""A named effect's parameters fitted to each record alone: constant where the law is right."""

import numpy as np

from .candidates import Pair
from .screening import calibrate


def by_level(bench, null, measured, finalist, scales):
    """Return [{parameter, unit, load_rms_N, gap_m, value, low, high}], a row per parameter with
    lists over the null's records; [] for a pair.

    measured (record, feature); each record is fitted together with the lowest one, whose reading
    every fit shares.
    """
    candidate = finalist.candidate
    if isinstance(candidate, Pair):
        return []
    alone = [
        calibrate(bench, finalist.own(null), measured, candidate, finalist.path, chosen)
        for chosen in np.eye(len(measured), dtype=bool)
    ]
    rows = []
    for number, parameter in enumerate(candidate.effect.parameters):
        values, ends = [], []
        for found in alone:
            moved = np.repeat(found.unit[None], 3, axis=0)
            moved[1:, number] = found.interval[number]
            sizes = [candidate.physical(unit, scales)[parameter.name] for unit in moved]
            values.append(sizes[0])
            ends.append(sorted(sizes))
        rows.append(
            {
                "parameter": parameter.name,
                "unit": parameter.unit,
                "load_rms_N": bench.signals.load[null.records].tolist(),
                "gap_m": bench.signals.gap[null.records].tolist(),
                "value": values,
                "low": [row[0] for row in ends],
                "high": [row[-1] for row in ends],
            }
        )
    return rows
