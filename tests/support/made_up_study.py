"""A study whose every number is set here by a formula: tables, records, spectra and shapes.

The reduced model is that of the smoke study. Nothing is simulated.
"""

from pathlib import Path

import numpy as np
import xarray as xr

from vibroimpact.config.reading import load_config
from vibroimpact.config.stage_keys import stage_params
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.reports.captions import Caption
from vibroimpact.reports.equivalent_answer import answers
from vibroimpact.reports.figures.interactive.study_plots import StudyFiles, study_plots
from vibroimpact.reports.figures.study.checks import limits
from vibroimpact.reports.study_content import provenance, study_content
from vibroimpact.reports.study_page import Picture, study_page
from vibroimpact.reports.study_statistics import study_statistics
from vibroimpact.study.cases import all_cases
from vibroimpact.study.equivalent_table import equivalent_rows

ROOT = Path(__file__).parents[2]
LOADS, GAPS, SEEDS = (0.1, 1.0, 10.0), (2.0e-4, 5.0e-5), 2
CHANGES = {"grid": {"load_rms_N": list(LOADS), "gap_m": list(GAPS), "seeds": SEEDS}}
RESOLVED_FROM = 1.0  # N RMS
STRESS_LIMIT_Pa = 240.0e6
ONE_PIXEL = (
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mNkYAAAAAYAAjCB0C8AAAAASUVORK5CYII="
)


def made_up_config(**sections):
    """The smoke configuration with the grid of the made-up study, as the page's stage gets it."""
    config = load_config(ROOT / "config" / "smoke.yaml", {**CHANGES, **sections})
    return StageSettings(stage_params(config, "study_page"))


def stiffness(gap_m, load_rms_N, method):
    """k in N/m per support; the methods are within 10 % of one another."""
    share = {"lscf": 1.0, "ods": 0.9, "broadband": 1.1}[method]
    return share * 10.0 * load_rms_N / gap_m if load_rms_N >= RESOLVED_FROM else np.nan


def damping(gap_m, load_rms_N, method):
    """c in N s/m per support; at the largest load the two methods differ by a factor of two."""
    if method == "ods" or load_rms_N < RESOLVED_FROM:
        return np.nan
    return 50.0 * load_rms_N * (2.0 if method == "broadband" and load_rms_N == LOADS[-1] else 1.0)


def summary_rows():
    """Rows of consistency_summary.csv."""
    rows = []
    for gap in GAPS:
        for load in LOADS:
            for method in ("lscf", "ods", "broadband"):
                k, c = stiffness(gap, load, method), damping(gap, load, method)
                rows.append(
                    {
                        "gap_m": gap,
                        "load_rms_N": load,
                        "load_over_gap": load / gap,
                        "group": "all",
                        "direction": "y",
                        "method": method,
                        "k_median": k,
                        "k_low": 0.95 * k,
                        "k_high": 1.05 * k,
                        "c_median": c,
                        "c_low": 0.6 * c,
                        "c_high": 1.5 * c,
                        "ratio": 1.0,
                        "verdict_k": "agree" if load >= RESOLVED_FROM else "unresolved",
                    }
                )
    return rows


def rows_of_two_directions():
    """Rows of equivalent.csv: two directions, with reasons where there is no value."""
    rows = []
    for gap in GAPS:
        for load in LOADS:
            for number, direction in enumerate("xy", start=1):
                k, c = number * stiffness(gap, load, "lscf"), damping(gap, load, "lscf")
                there = load >= RESOLVED_FROM
                rows.append(
                    {
                        "gap_m": gap,
                        "load_rms_N": load,
                        "load_over_gap": load / gap,
                        "group": "plates",
                        "direction": direction,
                        "k_N_per_m": k,
                        "k_low": 0.9 * k,
                        "k_high": 1.2 * k,
                        "c_N_s_per_m": c,
                        "c_low": 0.5 * c,
                        "c_high": 2.0 * c,
                        "secant_k_N_per_m": k,
                        "secant_c_N_s_per_m": c,
                        "agreement_k": "agree" if there else "unresolved",
                        "agreement_c": "spread" if there else "unresolved",
                        "reason_k": "" if there else f"k = {100 * load:.3g} N/m is too small",
                        "reason_c": "" if there else "no pole",
                        "k_bound": np.nan,
                        "contact_fraction": np.nan,
                    }
                )
    return rows


def record(case):
    """The record of a case: the support on the left is touched twice as much as the other."""
    touched = 0.04 * case.load_rms_N if case.load_rms_N >= RESOLVED_FROM else 0.0
    per_support = np.array([2.0, 1.0]) * touched
    return xr.Dataset(
        {
            "contact_fraction": ("support", per_support, {"units": "1"}),
            "impact_rate": ("support", 100.0 * per_support, {"units": "s-1"}),
            "rms_force": ("support", 50.0 * per_support, {"units": "N"}),
            "peak_force": ("support", 500.0 * per_support + 10.0 * case.seed, {"units": "N"}),
            "wear_work_rate": ("support", 0.01 * per_support, {"units": "W"}),
            "stress_rms": ("section", np.array([5e6, 3e6]) * case.load_rms_N, {"units": "Pa"}),
            "stress_peak": ("section", np.array([25e6, 9e6]) * case.load_rms_N, {"units": "Pa"}),
            "stress_flag": ((), int(25e6 * case.load_rms_N > STRESS_LIMIT_Pa), {"units": "1"}),
            "energy_residual": ((), 1e-5 * case.load_rms_N, {"units": "1"}),
            "potential_energy_residual": ((), 1e-3, {"units": "1"}),
            "fixed_point_residual": ((), 0.0, {"units": "1"}),
        },
        {"support": ["left", "right"], "section": ["root_start", "left_middle"]},
        {"load_rms_N": case.load_rms_N, "gap_m": case.gap_m, "seed": case.seed},
    )


def spectrum(case, sensors):
    """The spectra of a case: a resonance whose frequency rises with the load."""
    frequency = np.arange(0.0, 512.0, 0.25)
    peak = 16.0 + case.load_rms_N
    shape = case.load_rms_N**2 / ((frequency**2 - peak**2) ** 2 + (0.06 * peak * frequency) ** 2)
    levels = np.outer(np.arange(1.0, len(sensors) + 1.0), 1e-6 * shape + 1e-16)
    return xr.Dataset(
        {
            "psd_displacement_mean": (("sensor", "frequency"), levels),
            "psd_displacement_min": (("sensor", "frequency"), 0.1 * levels),
            "psd_displacement_max": (("sensor", "frequency"), 4.0 * levels),
        },
        {"sensor": list(sensors), "frequency": frequency},
    )


def curves(case, points):
    """The shape of a case: half a sine, a tenth of it in quadrature."""
    half_sine = np.sin(np.pi * np.linspace(0.0, 1.0, points + 2)[1:-1])
    return xr.Dataset(
        {"ods_re": ("line_point", half_sine), "ods_im": ("line_point", 0.1 * half_sine**3)}
    )


class MadeUpStudy:
    """The made-up study: its content, its files and its page.

    equivalent: rows of equivalent.csv, None for those of the summary.
    """

    def __init__(self, model, equivalent=None):
        self.config, self.model = made_up_config(), model
        cases = {case.id: case for case in all_cases(self.config.grid)}
        self.paths = [f"{name}.nc" for name in cases]
        self.records = {f"{name}.nc": record(case) for name, case in cases.items()}
        self.spectra = {
            f"{name}.nc": spectrum(case, model.sensor_names) for name, case in cases.items()
        }
        self.curves = {
            f"{name}.nc": curves(case, model.line_arc_length.size) for name, case in cases.items()
        }
        statistics = study_statistics(self.paths, lambda path, names=None: self.records[path])
        self.summary = summary_rows()
        self.content = study_content(
            self.config,
            answers(self.summary, equivalent or equivalent_rows(self.summary)),
            statistics,
            provenance(
                {"study": "made_up", "grid": {"seeds": SEEDS}},
                {"simulation": {"config_digest": "0a1b", "source_digest": "2c3d", "versions": "v"}},
            ),
            limits=limits(self.config.integration),
        )

    def read(self, path, names=None):
        """What records.read_record returns: some of the spectra, or all of the estimates."""
        return (self.curves if names is None else self.spectra)[path]

    def plots(self):
        """The plots of the page."""
        files = StudyFiles(self.model, [], self.paths, self.paths, self.summary, self.read)
        return study_plots(self.content, files)

    def page(self):
        """The HTML page, with one picture."""
        caption = Caption("layout", "Model", "Layout", "One sentence. Another one.")
        return study_page(self.content, self.plots(), [Picture(caption, "In full.", ONE_PIXEL)])
