"""The figures of a measured tube's equivalent supports: 5, 6 and 13."""

from pathlib import Path

import numpy as np

from vibroimpact.config.stage_keys import answer_digest
from vibroimpact.equivalent_support.homogeneity import effects_with_a_scale
from vibroimpact.identify.spectra.welch import driven_axis
from vibroimpact.io.records import read_table
from vibroimpact.study.case_files import read_case
from vibroimpact.study.cases import case_from_id
from vibroimpact.study.equivalent_table import DIGEST_COLUMN

from .cases_of_gap import shown_gap
from .equivalent import figure_13_equivalent_support
from .overlay import figure_05_measured
from .psd_table import Responses, driven_sensor, gather, spectra_shown
from .response import figure_06_levels

SAME_GAP = 0.02  # largest relative difference of gaps whose spectra are drawn over each other


def study_beside(config, folder):
    """Return (configuration, rows of consistency.csv, paths of spectra) of the study of the same
    tube in a folder; None if it holds no finished study, or one of another configuration.
    """
    table = Path(folder) / "consistency.csv"
    if config.identification is None or not table.is_file():
        return None
    rows, own = read_table(table, (DIGEST_COLUMN,)), answer_digest(config.model_dump(mode="json"))
    if {row.get(DIGEST_COLUMN, own) for row in rows} != {own}:
        return None
    paths = sorted(map(str, (Path(folder) / "spectra").glob("*.nc")))
    return config, rows, paths


def measured_figures(found, beside=None):
    """Return the Plots of a MeasuredSupports; beside: of study_beside."""
    config, model, level = found.config, found.model, found.levels
    responses, gap = gather(config, model, found.spectra.values()), shown_gap(config)
    beside = beside if level == "load_rms_N" else None
    over = (
        " Grey: the study of the same tube, median of its compared methods and their range"
        " over seeds, at the same load over gap."
    )
    caption = (
        "Equivalent bilateral support of the measured tube by each method against load: stiffness k"
        " (top) and damping c on top of the modal damping (bottom), per support; median over"
        " records, bars from the smallest to the largest record. Unresolved values are"
        f" left out. The shape carries no damping.{over if beside else ''} Dashed: the contact"
        " stiffness of the model, the upper limit."
    )
    study = _study_rows(found, beside[1]) if beside else None
    simulated = _simulated(found, beside, gap) if beside else None
    return [
        figure_13_equivalent_support(config, model, found.rows, level, study, caption),
        figure_05_measured(config, model, responses, _supports(found, gap), simulated, level),
        figure_06_levels(config, model, responses, level),
    ]


def _supports(found, gap):
    """Return {load: (k, c, relative PSD (low_frequency,) of the force or None)} of the recommended
    values at a gap, if one pair serves all.
    """
    places = {(row["group"], row["direction"]) for row in found.rows}
    if len(places) > 1:
        return {}
    psds = {
        case.load_rms_N: dataset.get("force_psd")
        for case, dataset in found.spectra.items()
        if case.gap_m == gap
    }
    return {
        row["load_rms_N"]: (row["k_N_per_m"], row["c_N_s_per_m"], psds[row["load_rms_N"]])
        for row in found.equivalent
        if row["gap_m"] == gap and np.isfinite([row["k_N_per_m"], row["c_N_s_per_m"]]).all()
    }


def _study_rows(found, study):
    """Return {gap of the campaign: rows of the study's nearest gap, at the same load over gap}.

    If a model has effects with a scale of their own, only the same gap is comparable.
    """
    gaps = sorted({row["gap_m"] for row in study})
    fixed = bool(effects_with_a_scale(found.model))
    rows = {}
    for gap in found.config.grid.gap_m:
        nearest = min(gaps, key=lambda other: abs(np.log(other / gap)))
        if fixed and abs(nearest / gap - 1.0) > SAME_GAP:
            continue
        rows[gap] = [
            {**row, "load_rms_N": row["load_rms_N"] * gap / nearest}
            for row in study
            if row["gap_m"] == nearest
        ]
    return rows


def _simulated(found, beside, gap):
    """Return the Responses of the study at the gap and sensor of figure 5, None without these."""
    studied, _, spectra = beside
    same = [each for each in studied.grid.gap_m if abs(each / gap - 1.0) < SAME_GAP]
    point = studied.identification.response_point
    at = found.model.sensor_names.index(
        driven_sensor(found.config, found.config.identification.response_point)
    )
    place = studied.points.get(point, (np.nan,) * 3)
    away = np.linalg.norm(found.model.sensor_positions[at] - np.array(place))
    axis = driven_axis(studied.excitation.direction)
    paths = [path for path in spectra if case_from_id(Path(path).stem).gap_m in same]
    if not paths or not away < 0.01 or axis != driven_axis(found.config.excitation.direction):
        return None
    config = studied.model_copy(
        update={"grid": studied.grid.model_copy(update={"gap_m": tuple(same)})}
    )
    whole = gather(config, found.model, spectra_shown(config, paths, read_case))
    name = driven_sensor(config, point)
    psd = {key: values for key, values in whole.psd.items() if key[1] == name}
    return Responses(whole.gap_m, whole.load, whole.frequency, psd, [])
