"""The error of the laws of the equivalent support, measured on tubes they were not fitted on.

Each tube is simulated at loads that put its free motion at given multiples of the gap. The laws' k
and c are compared with what the methods identify and with the secant stiffness of the contacts.
"""

from collections.abc import Iterable, Iterator

import numpy as np

from vibroimpact.config.reading import check_config
from vibroimpact.equivalent_support.displacement_law import held_tube
from vibroimpact.identify.estimate import table_rows
from vibroimpact.identify.identify_case import identify_case
from vibroimpact.identify.linear.modes import natural_frequencies
from vibroimpact.io.provenance import config_digest
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.study.case_spectra import case_spectra
from vibroimpact.study.cases import Case
from vibroimpact.study.method_agreement import COMPARED, summary_rows
from vibroimpact.study.simulation import simulate_cases

from .laws import fit_displacement_law, fit_law, plate_stiffness

LEVELS = (0.6, 1.0, 1.7, 3.0, 5.0, 9.0, 16.0, 24.0)  # inside what the default study covers
SEEDS = 2
GAP_OF_DIAMETER = 0.013
RECORD, SPECTRA, INTEGRATION = {"duration_s": 24.0}, {"segment_s": 8.0}, {"start_up_s": 2.0}
FEWEST_METHODS = 2  # that must resolve k
FARTHEST = 2.0  # largest over smallest of the methods that make one observation
QUANTILES = (0.1, 0.9)
OBSERVED_K = ("k_identified", "k_secant")
LOWEST_STIFFNESS = 1.0e2  # N/m
# Regions of the level that the errors are given for: hardly touching, transition, rattling.
REGIONS = ((0.5, 1.5), (1.5, 6.0), (6.0, 30.0))


def other_tube(config, name, keys):
    """Return (Config, ModalModel) of a tube with identification bands about its own frequencies.

    config: the study's, whose keys count where `keys` has none. keys: with the points "drive" and
    "seen", where the force acts and where the response is read.
    """
    data = config.model_dump(mode="json")
    data |= {"study": name, "excitation": {**data["excitation"], "point": "drive"}} | keys
    data["record"] |= {**RECORD, "sensors": {"points": ["seen", "drive"], "directions": ["x", "y"]}}
    data["spectra"] |= SPECTRA
    data["integration"] |= INTEGRATION
    data["identification"] = None
    model = build_model(check_config(data, name))
    data["identification"] = _identification(model, data["excitation"]["band_Hz"])
    return check_config(data, name), model


def _identification(model, band_Hz):
    """Return the keys of the identification: bands from the first frequency without and with the
    contact's stiffness, inside the band of the force.
    """
    contact = max(np.bincount(model.support_of_point, model.contact_stiffness))
    free, held = (natural_frequencies(model, k, 1)[0] for k in (0.0, contact))
    first, last = max(0.7 * free, band_Hz[0] + 0.5), band_Hz[1] - 1.0
    return {
        "response_point": "seen",
        "peak_search_Hz": [first, min(1.4 * held, last)],
        "lscf": {
            "band_Hz": [first, min(2.0 * held, last)],
            "max_order": 24,
            "references": ["seen", "drive"],
        },
        "broadband": {"point": "drive", "band_Hz": [first, min(4.0 * held, last)]},
        "stiffness_range_N_per_m": [LOWEST_STIFFNESS, 1.0e8],
    }


def tube_rows(config, name, keys, law, stiffness_law, levels=LEVELS, seeds=SEEDS) -> Iterator[dict]:
    """Yield one row per level of a tube: laws beside what the simulation shows.

    law: DisplacementLaw. stiffness_law: EquivalentLaw over the static stiffness, for comparison.

    Row keys: tube, level, load_rms_N, gap_m, k_law, c_law, k_stiffness_law, k_identified,
    c_identified (medians of the compared methods; NaN where fewer than two of them resolve k, none
    resolves c, or they are a factor 2 apart), k_secant.
    """
    changed, model = other_tube(config, name, keys)
    gap = GAP_OF_DIAMETER * changed.structure.section.outer_diameter_m
    tube = held_tube(model, changed.excitation.band_Hz)
    loads = [float(f"{level / tube.level(1.0, gap):.6g}") for level in levels]
    rows = []
    cases = [Case(load, gap, seed) for load in loads for seed in range(seeds)]
    for _, record in simulate_cases(changed, model, cases):
        estimates, _ = identify_case(changed, model, record, case_spectra(changed, record))
        rows += table_rows(estimates, record.attrs)
    summary = summary_rows(rows)
    for load in loads:
        methods = {row["method"]: row for row in summary if row["load_rms_N"] == load}
        level = tube.level(load, gap)
        k, c = law.at(tube, load, gap)
        yield {
            "tube": name,
            "level": level,
            "load_rms_N": load,
            "gap_m": gap,
            "k_law": k,
            "c_law": c,
            "k_stiffness_law": (
                stiffness_law.at(level)[0] * plate_stiffness(model)[0]
                if stiffness_law.inside(level)
                else np.nan
            ),
            "k_identified": _median(methods, "k_median", FEWEST_METHODS),
            "c_identified": _median(methods, "c_median", 1),
            "k_secant": methods["secant"]["k_median"],
        }


def _median(methods, column, fewest):
    """Return the median of the compared methods that resolve a value.

    NaN for too few, and where they are too far apart to be one observation.
    """
    values = [methods[method][column] for method in COMPARED]
    resolved = [value for value in values if np.isfinite(value)]
    if len(resolved) < fewest or max(resolved) > FARTHEST * min(resolved):
        return np.nan
    return float(np.median(resolved))


def error_rows(rows: Iterable[dict]) -> list[dict]:
    """Return the measured error by region of the level: observed over the law.

    Row keys: level_from, level_to, tubes, cases, and for k and c the median, the 10 % and 90 %
    quantiles (k_median, k_low, k_high, c_...), and k_factor_90: the factor, up or down, that 90 %
    of the cases stay within, also of the law over the static stiffness. k is both the identified
    and the secant one, each a case of its own, so that a level that no method resolves counts too.
    """
    rows, table = list(rows), []
    for low, high in (*REGIONS, (REGIONS[0][0], REGIONS[-1][1])):
        inside = [row for row in rows if low <= row["level"] < high]
        values = {
            "level_from": low,
            "level_to": high,
            "tubes": len({row["tube"] for row in inside}),
            "cases": len(inside),
        }
        for name, observed in (("k", OBSERVED_K), ("c", ("c_identified",))):
            ratios = _ratios(inside, observed, f"{name}_law")
            values[f"{name}_median"] = _quantile(ratios, 0.5)
            values[f"{name}_low"] = _quantile(ratios, QUANTILES[0])
            values[f"{name}_high"] = _quantile(ratios, QUANTILES[1])
        for name, law in (("", "k_law"), ("_stiffness_law", "k_stiffness_law")):
            logarithms = np.abs(np.log(_ratios(inside, OBSERVED_K, law)))
            values[f"k_factor_90{name}"] = float(np.exp(_quantile(logarithms, QUANTILES[1])))
        table.append(values)
    return table


def _quantile(values, share):
    """Return a quantile, NaN of nothing."""
    return float(np.quantile(values, share)) if len(values) else np.nan


def _ratios(rows, observed, law):
    """Return the finite positive ratios of observed columns over that of a law."""
    ratios = np.array([row[column] / row[law] for row in rows for column in observed if row[law]])
    return ratios[np.isfinite(ratios) & (ratios > 0.0)]


def measured_law(config, model, summary, tubes):
    """Return (DisplacementLaw of a study, rows of tube_rows of every other tube, origin).

    summary: rows of the study's consistency_summary.csv. tubes: {name: keys of a configuration}.
    """
    band = config.excitation.band_Hz
    tube = held_tube(model, band)
    law = fit_displacement_law(summary, tube)
    stiffness_law = fit_law(
        summary, lambda load, gap: tube.level(load, gap), plate_stiffness(model)
    )
    rows = [
        row
        for name, keys in tubes.items()
        for row in tube_rows(config, name, keys, law, stiffness_law)
    ]
    cases = {(row["gap_m"], row["load_rms_N"]) for row in summary}
    origin = {
        "made_by": "snakemake -j2 equivalent_law",
        "study": config.study,
        "config_digest": config_digest(config.model_dump(mode="json")),
        "loads_and_gaps": len(cases),
        "seeds": config.grid.seeds,
        "duration_s": config.record.duration_s,
        "methods": list(COMPARED),
        "errors_on": list(tubes),
    }
    return law, rows, origin
