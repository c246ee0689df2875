"""The records of two public benchmarks as campaigns: the F-16 ground vibration test and the
Silverbox.

Sources: J.P. Noel, M. Schoukens, "F-16 aircraft benchmark based on ground vibration test data",
Workshop on Nonlinear System Identification Benchmarks, 2017; J.P. Noel, J. Schoukens, "Grey-box
state-space identification of nonlinear mechanical vibrations", Int. J. Control 2017. Levels that
the benchmarks give for estimation are fitted; every other level found in the folder is held out.
The positions of the aircraft's sensors are not published: points are nominal, a metre apart, so
that each has its own.
"""

import re
from pathlib import Path

import numpy as np
from scipy.io import loadmat

from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.spectra.periodic_lines import PeriodError, find_period

F16_LEVEL = re.compile(r"F16Data_FullMSine_Level(\d+)(_Validation)?$")
F16_FITTED = (1, 3, 5, 7)
SILVERBOX_INPUT = re.compile(r"SNJP_um_full_FNSI_(\d+(?:\.\d+)?)$")
SILVERBOX_FITTED = (5.0, 20.0, 100.0)
SILVERBOX_TRANSIENT, F16_TRANSIENT = 5, 1  # periods


def f16_campaign(paths):
    """Return the campaign Dataset of level files; a level given both with and without _Validation
    is held out.

    Raises ValueError: no level in a name, other variables than expected, or rates that differ.
    """
    records = {}
    for path in sorted(map(Path, paths)):
        found = F16_LEVEL.search(path.stem)
        if found is None:
            raise ValueError(
                f"{path}: the name must hold the level, as in F16Data_FullMSine_Level3.mat"
            )
        level, data = int(found.group(1)), _variables(path, ("Force", "Acceleration", "Fs"))
        fitted = level in F16_FITTED and found.group(2) is None
        key = (level, found.group(2) or "")
        name = (
            f"level {level} validation"
            if found.group(2) and (level, "") in records
            else f"level {level}"
        )
        records[key] = (
            name,
            "fit" if fitted else "holdout",
            data["Force"].reshape(1, -1),
            data["Acceleration"],
            float(data["Fs"].ravel()[0]),
        )
    channels = [
        Channel(
            f"acceleration {number + 1}",
            (float(number), 0.0, 0.0),
            (0.0, 0.0, 1.0),
            "m s-2",
            "acceleration",
        )
        for number in range(3)
    ]
    drive = Channel("force", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), "N", "force")
    source = (
        "F-16 ground vibration test, Noel and Schoukens 2017, full multisine; positions nominal"
    )
    return _campaign(
        [records[key] for key in sorted(records)], channels, drive, F16_TRANSIENT, source
    )


def benchmark_campaign(name, paths):
    """Return the campaign Dataset of the records of a study, f16 or silverbox."""
    return {"f16": f16_campaign, "silverbox": silverbox_campaign}[name](paths)


def silverbox_campaign(paths):
    """Return the campaign Dataset of files SNJP_um_full_FNSI_<mV>.mat, the outputs SNJP_ym_...
    beside them. Raises as f16_campaign does.
    """
    records = []
    for path in (path for path in sorted(map(Path, paths)) if "_um_" in path.name):
        found = SILVERBOX_INPUT.search(path.stem)
        if found is None:
            raise ValueError(
                f"{path}: the name must hold the level in mV, as in SNJP_um_full_FNSI_20.mat"
            )
        level = float(found.group(1))
        driven = _variables(path, ("um", "fs"))
        answer = _variables(path.with_name(path.name.replace("_um_", "_ym_")), ("ym",))
        records.append(
            (
                level,
                (
                    f"{level:g} mV",
                    "fit" if level in SILVERBOX_FITTED else "holdout",
                    driven["um"].reshape(1, -1),
                    answer["ym"].reshape(1, -1),
                    float(driven["fs"].ravel()[0]),
                ),
            )
        )
    channel = Channel("output", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), "V", "generic")
    drive = Channel("input", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), "V", "generic")
    return _campaign(
        [record for _, record in sorted(records, key=lambda item: item[0])],
        [channel],
        drive,
        SILVERBOX_TRANSIENT,
        "Silverbox, Noel and Schoukens 2017, full multisine",
    )


def _variables(path, names):
    """Return {name: array} of a MATLAB file."""
    if not Path(path).is_file():
        raise ValueError(f"{path}: no such file: input and output of a level belong together")
    data = loadmat(path)
    missing = [name for name in names if name not in data]
    if missing:
        raise ValueError(
            f"{path}: has no variable {', '.join(missing)}: it holds"
            f" {', '.join(name for name in data if not name.startswith('__'))}"
        )
    return {name: np.asarray(data[name], float) for name in names}


def _campaign(records, channels, drive, transient, source):
    """Return the Dataset of [(name, split, force (1, time), response (channel, time), rate Hz)],
    padded to one length with NaN.
    """
    rates = sorted({rate for *_, rate in records})
    if len(rates) != 1:
        raise ValueError(
            f"{source}: records of different sampling frequencies {rates} Hz: give files of one"
        )
    count = [force.shape[1] for _, _, force, _, _ in records]
    force = np.full((len(records), 1, max(count)), np.nan)
    response = np.full((len(records), len(channels), max(count)), np.nan)
    for index, (_, _, driven, answer, _) in enumerate(records):
        force[index, :, : count[index]], response[index, :, : count[index]] = driven, answer
    levels = [Level(name, np.nan, 0, split) for name, split, *_ in records]
    optional = {"valid_samples": np.array(count)} if len(set(count)) > 1 else None
    return campaign_dataset(
        force,
        response,
        channels,
        [drive],
        levels,
        rates[0],
        optional,
        antialias="none",
        source=source,
        period_samples=_common_period(records),
        transient_periods=transient,
    )


def _common_period(records):
    """Return the samples of a period when all records have the same one, else 0: each record's is
    found again where it is used.
    """
    periods = set()
    for name, _, force, _, _ in records:
        try:
            periods.add(find_period(force[0], name))
        except PeriodError:
            periods.add(0)
    return periods.pop() if len(periods) == 1 else 0
