"""What the workflow must know of a discrepancy run before its jobs exist: their number and the
names of candidates.
"""

from pathlib import Path

from vibroimpact.records import read_json

QUICK_S = 16.0  # records are cut to it where the run must be quick
NULL_PARTS = (
    4  # jobs; each runs its share of the seeds with and without the damping of unseen modes
)


def screened_names(path):
    """Return the names of the candidates that the first job (its file) left to be screened by
    simulation.
    """
    return read_json(path)["screened"]


def screened_files(names, folder, bank=""):
    """Return the files of the screened candidates of a run in a folder: those of a bank (another
    run's folder) where one is given and holds them, the run's own else.
    """
    own, known = Path(folder) / "paths", Path(bank or folder) / "paths"
    return [
        known / f"{name}.npz" if (known / f"{name}.npz").is_file() else own / f"{name}.npz"
        for name in names
    ]


def finalist_names(path):
    """Return the names of the finalists that a screening file names."""
    return list(read_json(path)["finalists"])


def pair_names(path):
    """Return the names of the pairs that a file of pairs names."""
    return list(read_json(path)["pairs"])
