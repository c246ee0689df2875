"""Cases of the prediction: other loads and gaps, another tube, and each load left out in turn."""

from pathlib import Path

import numpy as np

from vibroimpact.config.reading import changed_config, check_config
from vibroimpact.config.structure import UTube
from vibroimpact.geometry.sections import outer_width
from vibroimpact.identify.spectra.welch import psd_statistics, segment_spectra
from vibroimpact.io.records import read_record, read_table
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.study.cases import Case, load_values
from vibroimpact.study.simulation import simulate_cases

from .laws import FREE, fit_law, free_level, plate_stiffness
from .responses import amplified, linear_response, prediction_rows, recorded_response

GAPS_OF_DIAMETER = (0.005, 0.020)
LOADS_N = (1.5, 3.7, 8.0, 17.0)
SEEDS = 8
RUN = {"record.duration_s": 24.0}


def study_laws(config, model, results: Path, without_load=None):
    """Return {name: (law, level function, scale function)} of a finished study.

    law: EquivalentLaw. level function (model, load, gap) -> level; scale function model -> (k, c).
    """
    summary, band = read_table(results / "consistency_summary.csv"), config.excitation.band_Hz
    per_newton, stiffness = free_level(model, band), plate_stiffness(model)
    by_load = fit_law(summary, lambda load, gap: load / gap, without_load=without_load)
    scaled = fit_law(summary, lambda load, gap: load * per_newton / gap, stiffness, without_load)
    return {
        "load / gap": (by_load, lambda _, load, gap: load / gap, lambda _: (1.0, 1.0)),
        "scaled": (
            scaled,
            lambda tube, load, gap: load * free_level(tube, band) / gap,
            plate_stiffness,
        ),
    }


def predicted(laws, law, tube, load, gap, config):
    """Return (linear Response, k, c, inside) of a tube at a load and gap by one of the laws."""
    fitted, level_of, scale_of = laws[law]
    level, scale = level_of(tube, load, gap), scale_of(tube)
    k, c = (value * unit for value, unit in zip(fitted.at(level), scale, strict=True))
    k = max(k, FREE)
    return (
        linear_response(tube, k, c, load, config.excitation.band_Hz, config.record.duration_s),
        k,
        c,
        fitted.inside(level),
    )


def input_gain(config, model, results: Path, law):
    """Return (level (load,), gain (load,)) of the force of the equivalent linear tube.

    With this gain the linear tube has the RMS displacements of the study: mean over driven sensors
    and seeds, at the largest gap. The identified apparent damping widens the peaks but dissipates
    less than a real damper, so that the linear tube without gain responds too little.
    """
    gap, level, gain = float(max(config.grid.gap_m)), [], []
    for load in load_values(config.grid):
        seeds = _study_seeds(config, model, results, load, gap)
        linear, *_ = predicted({"law": law}, "law", model, load, gap, config)
        ratios = [
            np.sqrt(np.mean([seed.rms_displacement[name] ** 2 for seed in seeds]))
            / linear.rms_displacement[name]
            for name in _driven(config, model)
        ]
        level.append(law[1](model, load, gap))
        gain.append(np.mean(ratios))
    return np.array(level), np.array(gain)


def _driven(config, model):
    axis = "xyz"[int(np.argmax(np.abs(config.excitation.direction)))]
    return [name for name in model.sensor_names if name.endswith("." + axis)]


def _study_seeds(config, model, results, load, gap):
    """Return the non-linear Responses of the study at one load and gap, one per seed."""
    seeds = []
    for seed in range(config.grid.seeds):
        name = Case(load, gap, seed).id
        spectra = read_record(results / "spectra" / f"{name}.nc")
        psd = spectra["psd_displacement_mean"].values.astype(float)
        seeds.append(
            recorded_response(
                read_record(results / "records" / f"{name}.nc"),
                spectra["frequency"].values,
                psd,
                model.sensor_names,
            )
        )
    return seeds


def simulated_rows(config, geometry, laws, gains, gaps, loads=LOADS_N, seeds=SEEDS):
    """Return the prediction rows of a tube simulated at gaps (gap,) m and loads (load,) N.

    gains {law: (level, gain)}: every law is tried as it is and with its input gain.
    """
    tube = build_model(config)
    found = {}
    for case, record in simulate_cases(
        config,
        tube,
        [Case(load, gap, seed) for gap in gaps for load in loads for seed in range(seeds)],
    ):
        spectra = segment_spectra(
            record["displacement"].values, config.record.sampling_frequency_Hz, config.spectra
        )
        psd = psd_statistics(spectra.values)[0]
        found.setdefault((case.load_rms_N, case.gap_m), []).append(
            recorded_response(record, spectra.frequency, psd, tube.sensor_names)
        )
    rows = []
    for (load, gap), responses in found.items():
        for law in laws:
            linear, k, c, inside = predicted(laws, law, tube, load, gap, config)
            raised = float(
                np.interp(
                    np.log(laws[law][1](tube, load, gap)), np.log(gains[law][0]), gains[law][1]
                )
            )
            for name, gain in ((law, 1.0), (f"{law}, input gain", raised)):
                labels = {
                    "geometry": geometry,
                    "law": name,
                    "gap_m": gap,
                    "load_rms_N": load,
                    "k_N_per_m": k,
                    "c_N_s_per_m": c,
                    "input_gain": gain,
                    "inside_fit": inside,
                }
                rows += prediction_rows(
                    labels, amplified(linear, gain), responses, _driven(config, tube)
                )
    return rows


def left_out_rows(config, model, results: Path):
    """Return the prediction rows of the study's own records at its largest gap.

    Each load is predicted by a law fitted without it.
    """
    gap, rows = float(max(config.grid.gap_m)), []
    for load in load_values(config.grid)[::3]:
        laws = study_laws(config, model, results, without_load=load)
        linear, k, c, inside = predicted(laws, "load / gap", model, load, gap, config)
        labels = {
            "geometry": "study, load left out",
            "law": "load / gap",
            "gap_m": gap,
            "load_rms_N": load,
            "k_N_per_m": k,
            "c_N_s_per_m": c,
            "input_gain": 1.0,
            "inside_fit": inside,
        }
        rows += prediction_rows(
            labels, linear, _study_seeds(config, model, results, load, gap), _driven(config, model)
        )
    return rows


def case_rows(cases, config, model, results: Path, second):
    """Return the prediction rows of one group of cases: "left_out", "gaps" or "second_tube".

    config, model, results: of the finished study; second: keys that make another tube of the
    study's configuration.
    """
    if cases == "left_out":
        return left_out_rows(config, model, results)
    laws = study_laws(config, model, results)
    gains = {name: input_gain(config, model, results, law) for name, law in laws.items()}
    if cases == "gaps":
        diameter = outer_width(config.structure.section)
        return simulated_rows(
            changed_config(config, RUN),
            "study tube, other gaps and loads",
            laws,
            gains,
            [share * diameter for share in GAPS_OF_DIAMETER],
        )
    other = check_config({**config.model_dump(mode="json"), **second}, "the second tube")
    assert isinstance(other.structure, UTube), "the second tube is a U-tube"
    gap = (
        max(config.grid.gap_m)
        / outer_width(config.structure.section)
        * outer_width(other.structure.section)
    )
    return simulated_rows(changed_config(other, RUN), "second tube", laws, gains, [gap])
