"""Turn the records of the Silverbox into a campaign file.

    python examples/silverbox/records.py CAMPAIGN.nc FILE.mat [FILE.mat ...]

Source of the data: J.P. Noel, J. Schoukens, "Grey-box state-space identification of nonlinear
mechanical vibrations", Int. J. Control, 2017. Input and output are voltages. A circuit has no
positions: both lie at the origin, along one direction.
"""

import re
import sys
from pathlib import Path

import numpy as np
from scipy.io import loadmat

from vibroimpact.campaign.file import Channel, Level, campaign_dataset, write_campaign
from vibroimpact.campaign.signals import common_period

INPUT_NAME = re.compile(r"SNJP_um_full_FNSI_(\d+(?:\.\d+)?)$")
FITTED_MILLIVOLTS = (5.0, 20.0, 100.0)  # those that the benchmark gives for estimation
TRANSIENT_PERIODS = 5
ALONG = (0.0, 0.0, 1.0)
OUTPUT = Channel("output", (0.0, 0.0, 0.0), ALONG, "V", "generic")
INPUT = Channel("input", (0.0, 0.0, 0.0), ALONG, "V", "generic")


def silverbox_campaign(paths):
    """Return the campaign Dataset of files SNJP_um_full_FNSI_<mV>.mat, levels ascending.

    The output of each, SNJP_ym_full_FNSI_<mV>.mat, lies beside it. Levels that the benchmark gives
    for estimation are fitted, every other one is held out.

    Raises ValueError: a name without a level, a missing output, a file without a variable, or rates
    that differ.
    """
    inputs = [path for path in map(Path, paths) if "_um_" in path.name]
    records = dict(sorted(map(_record, inputs), key=lambda record: record[0]))
    rates = sorted({rate for *_, rate in records.values()})
    if len(rates) != 1:
        raise ValueError(f"Silverbox: records of different sampling frequencies {rates} Hz")
    count = [force.shape[1] for force, _, _ in records.values()]
    force, response = (
        np.array([_padded(record[part], max(count)) for record in records.values()])
        for part in (0, 1)
    )
    return campaign_dataset(
        force,
        response,
        [OUTPUT],
        [INPUT],
        [
            Level(f"{level:g} mV", np.nan, 0, "fit" if level in FITTED_MILLIVOLTS else "holdout")
            for level in records
        ],
        rates[0],
        {"valid_samples": np.array(count)} if len(set(count)) > 1 else None,
        antialias="none",
        source="Silverbox, Noel and Schoukens 2017, full multisine",
        period_samples=common_period([record[0][0] for record in records.values()]),
        transient_periods=TRANSIENT_PERIODS,
    )


def _record(path):
    """(level mV, (input (1, time) V, output (1, time) V, rate Hz)) of an input file."""
    found = INPUT_NAME.search(path.stem)
    if found is None:
        raise ValueError(
            f"{path}: the name must hold the level in mV, as in SNJP_um_full_FNSI_20.mat"
        )
    driven = _variables(path, ("um", "fs"))
    answer = _variables(path.with_name(path.name.replace("_um_", "_ym_")), ("ym",))
    return float(found.group(1)), (
        driven["um"].reshape(1, -1),
        answer["ym"].reshape(1, -1),
        float(driven["fs"].ravel()[0]),
    )


def _variables(path, names):
    """{name: array} of a MATLAB file."""
    if not path.is_file():
        raise ValueError(f"{path}: no such file: input and output of a level belong together")
    data = loadmat(path)
    missing = [name for name in names if name not in data]
    if missing:
        raise ValueError(f"{path}: has no variable {', '.join(missing)}")
    return {name: np.asarray(data[name], float) for name in names}


def _padded(signals, length):
    """Signals (channel, time) with NaN up to a length."""
    return np.pad(signals, ((0, 0), (0, length - signals.shape[1])), constant_values=np.nan)


if __name__ == "__main__":
    campaign_file, *record_files = sys.argv[1:]
    try:
        write_campaign(silverbox_campaign(record_files), campaign_file)
    except ValueError as error:
        sys.exit(str(error))
