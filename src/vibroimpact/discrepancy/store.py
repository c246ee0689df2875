"""The files between the jobs of a discrepancy run: arrays as .npz, readings and texts as JSON
inside them.
"""

import json
import zipfile
from dataclasses import asdict

import numpy as np

from vibroimpact.records import MAKE_AGAIN
from vibroimpact.whole_file import RecordError, whole_file

from .candidates import candidate_named
from .finalists import Finalist
from .nuisance import Nuisance, Reading
from .null import null_of
from .screening import Path

ALONE = "alone_"  # before the names of arrays of a path without the linear effect that was adopted
UNSEEN = (
    "less_damped",
    "more_damped",
)  # names of the null's arrays with other damping of unseen modes
EMPTY = "empty"  # what a job writes where there is nothing to do


def save(path, **arrays):
    """Write arrays to a .npz file, whole or not at all."""
    with whole_file(path) as temporary, temporary.open("wb") as file:
        np.savez(file, **arrays)


def load(path):
    """Return {name: array} of a .npz file, None where a job had nothing to do.

    Raises RecordError where it cannot be read.
    """
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as data:
            return None if EMPTY in data else {name: data[name] for name in data.files}
    except (OSError, EOFError, ValueError, AttributeError, TypeError, zipfile.BadZipFile) as error:
        raise RecordError(f"{path}: cannot be read as .npz ({error}): {MAKE_AGAIN}") from error


def save_empty(path):
    """Write that there was nothing to do."""
    save(path, **{EMPTY: np.zeros(0)})


def path_arrays(path):
    """Return the arrays of a screening.Path."""
    readings = [
        (
            None
            if reading is None
            else {name: np.asarray(value).tolist() for name, value in asdict(reading).items()}
        )
        for reading in path.readings
    ]
    return {
        "parameters": path.parameters,
        "features": path.features,
        "seeds": path.seeds,
        "differences": path.differences,
        "readings": np.array(json.dumps(readings)),
    }


def path_of(arrays, prefix=""):
    """Return the screening.Path of arrays whose names begin with a prefix, None where there are
    none.
    """
    if f"{prefix}parameters" not in arrays:
        return None
    arrays = {
        name.removeprefix(prefix): value
        for name, value in arrays.items()
        if name.startswith(prefix)
    }
    readings = [
        (
            None
            if row is None
            else Reading(
                *[
                    np.array(row[name])
                    for name in (
                        "modes",
                        "log_frequency",
                        "log_damping",
                        "participation",
                        "residual",
                    )
                ]
            )
        )
        for row in json.loads(str(arrays["readings"]))
    ]
    return Path(
        arrays["parameters"],
        arrays["features"],
        arrays["seeds"],
        readings,
        arrays.get("differences"),
    )


def finalist_arrays(finalist):
    """Return the arrays of a finalists.Finalist."""
    profile = json.dumps([[np.asarray(part).tolist() for part in row] for row in finalist.profile])
    return {
        "name": np.array(finalist.candidate.name),
        "unit": finalist.unit,
        "interval": finalist.interval,
        "scores": finalist.scores,
        "low": np.array(finalist.low),
        "runs": finalist.features,
        "free": finalist.free,
        "parts": finalist.parts,
        "profile": np.array(profile),
        **(
            {}
            if finalist.nuisance is None
            else {f"nuisance_{name}": value for name, value in asdict(finalist.nuisance).items()}
        ),
        **{f"path_{name}": value for name, value in path_arrays(finalist.path).items()},
    }


def finalist_of(arrays):
    """Return the finalists.Finalist of arrays."""
    path = path_of(
        {
            name.removeprefix("path_"): value
            for name, value in arrays.items()
            if name.startswith("path_")
        }
    )
    profile = [tuple(np.array(part) for part in row) for row in json.loads(str(arrays["profile"]))]
    nuisance = (
        Nuisance(
            **{
                name: arrays[f"nuisance_{name}"]
                for name in ("modes", "frequency", "damping", "gain")
            }
        )
        if "nuisance_modes" in arrays
        else None
    )
    return Finalist(
        candidate_named(str(arrays["name"])),
        arrays["unit"],
        arrays["interval"],
        arrays["scores"],
        float(arrays["low"]),
        arrays["runs"],
        path,
        profile,
        arrays["free"],
        arrays["parts"],
        nuisance,
    )


def null_from(bench, files, prefix=""):
    """Return the Null of the files of its parts; prefix "screened_": of the seconds that are
    screened.
    """
    return null_of(bench, load(files[0])["records"], *null_features(files, prefix))


def null_features(files, prefix="", names=("features", *UNSEEN)):
    """Return [(record, seed, feature)] of the null and of that with less and more damping of unseen
    modes, of the files of its parts; a part holds some of them.
    """
    parts = [load(file) for file in files]
    return [
        np.concatenate([part[prefix + name] for part in parts if prefix + name in part], axis=1)
        for name in names
    ]
