"""Turn the records of the F-16 ground vibration test into a campaign file.

    python examples/f16/records.py CAMPAIGN.nc FILE.mat [FILE.mat ...]

Source of the data: J.P. Noel, M. Schoukens, "F-16 aircraft benchmark based on ground vibration test
data", Workshop on Nonlinear System Identification Benchmarks, 2017. The positions of the sensors
are not published: points are nominal, a metre apart, so that each channel has its own.
"""

import re
import sys
from pathlib import Path

import numpy as np
from scipy.io import loadmat

from vibroimpact.campaign.file import Channel, Level, campaign_dataset, write_campaign
from vibroimpact.campaign.signals import common_period

FILE_NAME = re.compile(r"F16Data_FullMSine_Level(\d+)(_Validation)?$")
FITTED_LEVELS = (1, 3, 5, 7)  # those that the benchmark gives for estimation
TRANSIENT_PERIODS = 1
UP = (0.0, 0.0, 1.0)
CHANNELS = [
    Channel(f"acceleration {number + 1}", (float(number), 0.0, 0.0), UP, "m s-2", "acceleration")
    for number in range(3)
]
DRIVE = Channel("force", (0.0, 0.0, 0.0), UP, "N", "force")


def f16_campaign(paths):
    """Return the campaign Dataset of level files, levels ascending.

    Levels that the benchmark gives for estimation are fitted. Every other level is held out, and so
    is every file whose name ends with _Validation.

    Raises ValueError: a name without a level, a file without a variable, or rates that differ.
    """
    records = dict(sorted(map(_record, paths), key=lambda record: record[0]))
    rates = sorted({rate for *_, rate in records.values()})
    if len(rates) != 1:
        raise ValueError(f"F-16: records of different sampling frequencies {rates} Hz")
    count = [force.shape[1] for force, _, _ in records.values()]
    force, response = (
        np.array([_padded(record[part], max(count)) for record in records.values()])
        for part in (0, 1)
    )
    return campaign_dataset(
        force,
        response,
        CHANNELS,
        [DRIVE],
        [_level(*key, records) for key in records],
        rates[0],
        {"valid_samples": np.array(count)} if len(set(count)) > 1 else None,
        antialias="none",
        source="F-16 ground vibration test, Noel and Schoukens 2017, full multisine; positions"
        " nominal",
        period_samples=common_period([record[0][0] for record in records.values()]),
        transient_periods=TRANSIENT_PERIODS,
    )


def _record(path):
    """((level, suffix), (force (1, time) N, response (channel, time) m/s², rate Hz)) of a file."""
    found = FILE_NAME.search(Path(path).stem)
    if found is None:
        raise ValueError(
            f"{path}: the name must hold the level, as in F16Data_FullMSine_Level3.mat"
        )
    data = loadmat(path)
    missing = [name for name in ("Force", "Acceleration", "Fs") if name not in data]
    if missing:
        raise ValueError(f"{path}: has no variable {', '.join(missing)}")
    key = int(found.group(1)), found.group(2) or ""
    return key, (
        np.asarray(data["Force"], float).reshape(1, -1),
        np.asarray(data["Acceleration"], float),
        float(data["Fs"].ravel()[0]),
    )


def _level(number, suffix, records):
    """The name and split of a record; a level given twice has two names."""
    twice = suffix and (number, "") in records
    split = "fit" if number in FITTED_LEVELS and not suffix else "holdout"
    return Level(f"level {number} validation" if twice else f"level {number}", np.nan, 0, split)


def _padded(signals, length):
    """Signals (channel, time) with NaN up to a length."""
    return np.pad(signals, ((0, 0), (0, length - signals.shape[1])), constant_values=np.nan)


if __name__ == "__main__":
    campaign_file, *record_files = sys.argv[1:]
    try:
        write_campaign(f16_campaign(record_files), campaign_file)
    except ValueError as error:
        sys.exit(str(error))
