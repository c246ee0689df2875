"""The cases that a figure of one gap shows: those of the largest gap, and a few of the loads."""

from pathlib import Path

import numpy as np

from vibroimpact.study.cases import case_from_id

from .seed_scatter import medians


def shown_gap(config):
    """Return the gap in m of the figures that show one gap: the largest."""
    return max(config.grid.gap_m)


def paths_of_gap(paths, gap_m):
    """Return the paths whose file name is the id of a case of a gap (m)."""
    return [path for path in paths if case_from_id(Path(path).stem).gap_m == gap_m]


def paths_at(paths, places):
    """Yield ((gap in m, load), path) of files named after cases at one of some (gap, load)."""
    for path in paths:
        case = case_from_id(Path(path).stem)
        if (case.gap_m, case.load_rms_N) in places:
            yield (case.gap_m, case.load_rms_N), path


class ReadOnDemand(dict):
    """{Case: read(path)} of {Case: path}; a file is read when its case is first asked for."""

    def __init__(self, paths, read):
        super().__init__()
        self._paths, self._read = paths, read

    def __missing__(self, case):
        self[case] = self._read(self._paths[case])
        return self[case]


def cases_of_gap(paths, config):
    """Return {Case: path} of the paths of the gap shown, ordered by case."""
    own = paths_of_gap(paths, shown_gap(config))
    return dict(sorted((case_from_id(Path(path).stem), path) for path in own))


def spread_loads(rows, count):
    """Return up to `count` loads in N RMS, ascending, with main peaks spread evenly in frequency.

    The frequency is that of LSCF, median over seeds. The lowest and the highest load are included;
    loads without a pole are not. rows: table rows of one gap.
    """
    load, frequency = medians(
        [row for row in rows if row["method"] == "lscf"], "load_rms_N", "frequency_Hz"
    )
    if load.size == 0:
        return sorted({row["load_rms_N"] for row in rows})[-1:]
    wanted = np.linspace(frequency[0], frequency.max(), count)[1:-1]
    between = {float(load[np.argmin(np.abs(frequency - value))]) for value in wanted}
    return sorted({float(load[0]), float(load[-1]), *between})


def first_seed(by_case):
    """Return {load in N RMS: Case} of the lowest seed among the keys of {Case: anything}."""
    lowest = min(case.seed for case in by_case)
    return {case.load_rms_N: case for case in by_case if case.seed == lowest}


def transition_load(rows):
    """Return the load in N RMS at which the main peak is widest.

    It has the largest median damping ratio of the LSCF pole among table rows; the largest load
    if no pole was found.
    """
    load, ratio = medians(
        [row for row in rows if row["method"] == "lscf"], "load_rms_N", "damping_ratio"
    )
    return float(load[np.argmax(ratio)]) if load.size else max(row["load_rms_N"] for row in rows)
