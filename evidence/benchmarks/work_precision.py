"""Work and precision of the two integration schemes: error against cost, for steps of many lengths.

    python -m evidence.benchmarks.work_precision [--seeds 16]
    -> results/benchmark/work_precision.csv, docs/figures/work_precision.png

R3: contact times of a mass driven against a stiff stop (published). R11: stationary statistics
between two stops under white noise (exact law). Tube: statistics of the stand-in tube at 5 and 20 N
RMS against Newmark at 1/204800 s, seed by seed; impacting motion is chaotic, so that below the
standard error of the seeds no difference can be told.
"""

import argparse
import os
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from evidence.benchmarks.table import write_csv
from evidence.benchmarks.work_precision_figure import draw
from evidence.validation.convergence import runs as convergence_runs
from evidence.validation.convergence.statistics import ENERGY, LARGEST_SCATTER
from evidence.validation.reference import (
    cases as reference_cases,
)
from evidence.validation.reference import (
    runs as reference_runs,
)
from evidence.validation.reference.random_stops import exact_law
from vibroimpact.config.reading import changed_config, load_config
from vibroimpact.reduction.reduced_model import build_model

COLUMNS = (
    "case",
    "quantity",
    "scheme",
    "steps_per_second",
    "error",
    "standard_error",
    "cpu_s_per_simulated_s",
)
SCHEMES = ("newmark", "exact")
R3_RATES = (100_000, 200_000, 400_000, 800_000, 1_600_000)
R11_RATES = (1600, 3200, 6400, 12800, 25600)
R11_SAMPLING_HZ = 160.0
R11_SEEDS = 64
R11_SIGMA = 1.0
R11_RATIO = 10.0
TUBE_RATES, TUBE_FINEST = (10240, 20480, 51200), 204800
REFERENCE = Path("config/reference")


def compile_kernels():
    """Run one record, and several at once: each way has kernels of its own."""
    few = {
        "r3_forced_impact.yaml": {"integration.steps_per_second": 20000},
        "r11_stops_10.yaml": {"grid.seeds": 2},
    }
    for name, keys in few.items():
        reference_runs.run(changed_config(load_config(REFERENCE / name), keys))


def timed(function, *arguments):
    """Return (result, CPU seconds)."""
    start = time.process_time()
    result = function(*arguments)
    return result, time.process_time() - start


def forced_impact_rows():
    """R3: RMS error of the contact times over the length of a contact."""
    config, rows = load_config(REFERENCE / "r3_forced_impact.yaml"), []
    contact_s = float(np.mean(np.diff(reference_cases.FORCED_CONTACT_S, axis=1)))
    for scheme in SCHEMES:
        for rate in R3_RATES:
            run = changed_config(
                config, {"integration.scheme": scheme, "integration.steps_per_second": rate}
            )
            records, cost = timed(reference_runs.run, run)
            error = reference_cases.contact_time_error(records[0]) / contact_s
            rows.append(
                dict(
                    zip(
                        COLUMNS,
                        (
                            "R3",
                            "contact times",
                            scheme,
                            rate,
                            error,
                            0.0,
                            cost / run.record.duration_s,
                        ),
                        strict=True,
                    )
                )
            )
    return rows


def random_stop_rows():
    """R11: relative error of the statistics, RMS over four of them, and its standard error."""
    config = load_config(REFERENCE / "r11_stops_10.yaml")
    law = exact_law(R11_SIGMA, R11_RATIO)
    rows = []
    omega = 2.0 * np.pi * build_model(config).full_mode_frequencies[0]
    gap = config.supports[0].gap_m
    expected = np.array(
        [
            law.displacement_rms * gap,
            law.contact_probability,
            law.force_rms * omega**2 * gap,
            2.0 * law.upcrossing_rate * omega,
        ]
    )
    of_step = config.grid.load_rms_N[1] / np.sqrt(
        config.integration.steps_per_second
    )  # white: RMS grows with the root of the rate
    for scheme in SCHEMES:
        for rate in R11_RATES:
            run = changed_config(
                config,
                {
                    "integration.scheme": scheme,
                    "integration.steps_per_second": rate,
                    "grid.seeds": R11_SEEDS,
                    "record.sampling_frequency_Hz": R11_SAMPLING_HZ,
                    "grid.load_rms_N": [of_step * np.sqrt(rate)],
                },
            )
            records, cost = timed(reference_runs.run, run)
            found = (
                np.array(
                    [
                        [
                            np.sqrt(record["displacement_square"].values[0, 0]),
                            record["contact_fraction"].values[0],
                            record["rms_force"].values[0],
                            record["impact_rate"].values[0],
                        ]
                        for record in records
                    ]
                )
                / expected
                - 1.0
            )
            spread = found.std(axis=0, ddof=1) / np.sqrt(len(found))
            seconds = len(records) * (run.record.duration_s + run.integration.start_up_s)
            values = (
                "R11",
                "stationary statistics",
                scheme,
                rate,
                _rms(found.mean(axis=0)),
                _rms(spread),
                cost / seconds,
            )
            rows.append(dict(zip(COLUMNS, values, strict=True)))
    return rows


def tube_rows(config, seeds):
    """The tube: relative difference of the statistics from Newmark at the finest step, RMS over
    those that one record resolves.
    """
    rows = []
    for load in convergence_runs.LOADS_N:
        finest, _ = timed(_tube, config, "newmark", TUBE_FINEST, load, seeds)
        resolved = finest.std(axis=0, ddof=1) <= LARGEST_SCATTER * finest.mean(axis=0)
        for scheme in SCHEMES:
            for rate in TUBE_RATES:
                found, cost = timed(_tube, config, scheme, rate, load, seeds)
                change = ((found - finest) / finest.mean(axis=0))[:, resolved]
                spread = change.std(axis=0, ddof=1) / np.sqrt(seeds)
                seconds = seeds * (
                    convergence_runs.RUN["record.duration_s"]
                    + convergence_runs.RUN["integration.start_up_s"]
                )
                values = (
                    f"tube, {load:g} N",
                    "response statistics",
                    scheme,
                    rate,
                    _rms(change.mean(axis=0)),
                    _rms(spread),
                    cost / seconds,
                )
                rows.append(dict(zip(COLUMNS, values, strict=True)))
    return rows


def _tube(config, scheme, rate, load, seeds):
    """Statistics (seed, statistic) of the tube; levels in dB as amplitudes."""
    axis = {"newmark": "step", "exact": "step_exact"}[scheme]
    rows = convergence_runs.run_rows(config, axis, values=(rate,), loads=(load,), seeds=seeds)
    names = [
        name
        for name in rows[0]
        if name not in ("axis", "value", "load_rms_N", "seed", "modes", ENERGY)
        and "apex.x" not in name
    ]
    return np.array(
        [
            [10.0 ** (row[name] / 20.0) if name.endswith("_dB") else row[name] for name in names]
            for row in rows
        ]
    )


def _rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def main():
    """Measure, write the table, draw."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=16, help="records per load of the tube")
    options = parser.parse_args()
    compile_kernels()
    rows = [
        *forced_impact_rows(),
        *random_stop_rows(),
        *tube_rows(load_config("config/study.yaml"), options.seeds),
    ]
    Path("results/benchmark").mkdir(parents=True, exist_ok=True)
    write_csv("results/benchmark/work_precision.csv", COLUMNS, rows)
    Path("docs/figures").mkdir(parents=True, exist_ok=True)
    draw(rows, "docs/figures/work_precision.png")
    for row in rows:
        print(*(f"{value:.3g}" if isinstance(value, float) else value for value in row.values()))


if __name__ == "__main__":
    main()
