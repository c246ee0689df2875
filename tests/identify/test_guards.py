"""What makes an estimate doubtful stands in the tables with its reason: each guard is tripped by
the response of a known linear tube or by a simulation, and a near case does not trip it.
"""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from tests.support.linear_records import LinearRecords, statistics
from tests.support.made_up_study import made_up_config
from tests.support.tiny_study import tiny_values
from vibroimpact.config.reading import changed_config, check_config, load_config
from vibroimpact.identify.estimate import PEAK_METHODS, Estimate, table_rows, unresolved
from vibroimpact.identify.guards import beyond_checked, guarded
from vibroimpact.identify.identify_case import identify_case, reference_tube
from vibroimpact.identify.linear.responses import frf
from vibroimpact.identify.reference_tube import STABLE_FRACTION
from vibroimpact.identify.spectra_layout import spectra_layout
from vibroimpact.identify.support_fit import SupportSearch
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.energy_limit import energy_flag
from vibroimpact.io.records import write_table
from vibroimpact.reports.figures.study.checks import limits
from vibroimpact.reports.study_statistics import StudyStatistics
from vibroimpact.reports.study_words import energy_sentences
from vibroimpact.study.agreement_dataset import consistency_dataset
from vibroimpact.study.case_spectra import case_spectra
from vibroimpact.study.cases import Case, all_cases
from vibroimpact.study.equivalent_table import equivalent_rows
from vibroimpact.study.in_process import reduced_model
from vibroimpact.study.method_agreement import consistency_rows, summary_rows
from vibroimpact.study.simulation import simulate_cases
from vibroimpact.study.statistics_table import statistics_rows
from vibroimpact_workflow.run_report import success_text

ROOT = Path(__file__).resolve().parents[2]
SENSORS = ("apex.y", "bend_45.y", "left_leg.y", "right_leg.y")
STIFFNESS, DAMPING = 1.0e5, 62.0525  # the first mode at 20.9 Hz with 3 %, the second at 53.8 Hz


@pytest.fixture(scope="module")
def tube():
    """The configuration and the model of the smoke study."""
    config = load_config(ROOT / "config" / "smoke.yaml")
    return config, reduced_model(config)


def rows_of(tube, keys=None, k=STIFFNESS, c=DAMPING, averages=18.0, **residuals):
    """{method: row of consistency.csv} of the smoke tube on a linear support, from exact spectra.

    residuals: of the energy balance of the record.
    """
    config, model = changed_config(tube[0], keys or {}), tube[1]
    columns = [model.sensor_names.index(name) for name in SENSORS]
    shapes = np.concatenate([model.sensor_shapes[:, columns], model.line_shapes], axis=1)
    linear = LinearRecords(config, SENSORS, lambda frequency: frf(model, k, c, frequency, shapes))
    spectra = linear.exact("hann").assign(effective_averages=averages)
    record = statistics(10).assign(residuals)
    attributes = record.attrs | {"seed": 0}
    rows = table_rows(identify_case(config, model, record, spectra)[0], attributes)
    return {row["method"]: row for row in rows}


def force_from(low_Hz):
    """Keys of a force from a frequency on, with the bands that must lie inside it."""
    return {
        "excitation.band_Hz": [low_Hz, 200.0],
        "identification.broadband.band_Hz": [low_Hz + 0.5, 99.0],
        "identification.lscf.band_Hz": [low_Hz + 0.5, 60.0],
    }


def flags_of(tube, *arguments, **more):
    """{method: flag} of the rows that have one."""
    found = rows_of(tube, *arguments, **more)
    return {name: row["flag"] for name, row in found.items() if row["flag"]}


def test_a_sound_case_has_no_flag(tube):
    rows = rows_of(tube)
    assert {row["flag"] for row in rows.values()} == {""}
    assert rows["lscf"]["k_N_per_m"] == pytest.approx(STIFFNESS, rel=0.02)


@pytest.mark.parametrize(
    ("work", "potential", "flag"),
    [
        (1e-4, 0.049, ""),
        (1e-4, 0.11, "the energy balance is open by 0.11 of the input work (limit 0.05)"),
        (0.06, np.nan, "the energy balance is open by 0.06 of the input work (limit 0.05)"),
        (1e-4, np.nan, ""),  # contacts that dissipate: no potential energy to compare with
        (np.nan, 0.0, "the energy balance is not a number"),
    ],
)
def test_an_open_energy_balance_is_flagged(work, potential, flag):
    residuals = {"energy_residual": work, "potential_energy_residual": potential}
    found = energy_flag(xr.Dataset(residuals))
    assert found.startswith(flag) and bool(found) == bool(flag)


def test_nothing_is_identified_from_an_open_energy_balance(tube):
    closed = rows_of(tube, energy_residual=1e-4, potential_energy_residual=0.049)
    rows = rows_of(tube, energy_residual=1e-4, potential_energy_residual=0.051)
    assert {row["flag"] for row in closed.values()} == {""}
    linearised = rows.pop("statistical_linearisation")  # it does not see the record
    assert linearised["flag"] == "" and np.isfinite(linearised["k_N_per_m"])
    for row in rows.values():
        assert np.isnan(row["k_N_per_m"]) and np.isnan(row["c_N_s_per_m"])
        assert row["quality"] == "unresolved"
        assert "raise integration.steps_per_second" in row["flag"]
        assert row["flag"] in row["reason"]


def test_few_averages_are_told(tube):
    rows = rows_of(tube, averages=7.9)
    text = "7.9 degrees of freedom of a spectral bin, fewer than 8"
    assert all(row["caution"].startswith(text) for row in rows.values())
    assert flags_of(tube, averages=7.9) == {}  # whatever the method: all keep their part
    assert {row["caution"] for row in rows_of(tube, averages=8.0).values()} == {""}


def test_a_stress_above_the_limit_and_the_contact_are_told(tube):
    stress = {"stress_flag": np.int8(1), "stress_peak": ("section", [1.0e8, 2.534e8])}
    touching = {"contact_fraction": ("support", [0.1, 0.3])}
    record = xr.Dataset(touching | stress, {"support": ["left", "right"]})
    estimates = [Estimate("lscf", 1e5, 1e3, group=name) for name in ("all", "left", "left+right")]
    found = guarded(estimates, record, 18.0, (8.0, 45.0))
    assert [estimate.contact_fraction for estimate in found] == [0.3, 0.1, 0.3]
    text = "the peak stress, 253 MPa, is above record.stress_limit_Pa"
    assert {estimate.caution for estimate in found} == {text}
    tables = [table_rows(found[:1], {"gap_m": 1e-4, "load_rms_N": 5.0, "seed": 0})]
    assert equivalent_rows(summary_rows(tables[0]))[0]["flag"] == f"1 of 1 seeds: {text}"
    (calm,) = guarded(estimates[:1], record.assign(stress_flag=np.int8(0)), 18.0, (8.0, 45.0))
    assert calm.caution == ""


def test_a_peak_that_is_not_crossed_is_flagged(tube):
    """The peak at 20.98 Hz falls to 1/2 at 20.5 Hz; without that flank its width is half the true
    one.
    """
    flags = flags_of(tube, force_from(20.8))
    assert set(flags) == set(PEAK_METHODS)
    assert flags["peak_half"].startswith("the fitted peak falls to 1/25 at 20 Hz, outside the")
    assert rows_of(tube, force_from(20.8))["peak_half"]["damping_ratio"] < 0.6 * 0.0229
    assert flags_of(tube, force_from(15.0)) == {}


def test_a_pole_outside_the_searched_band_is_flagged(tube):
    flags = flags_of(tube, {"identification.peak_search_Hz": [8.0, 20.5]})
    assert {*PEAK_METHODS, "lscf"} == set(flags)
    assert flags["peak_half"].endswith("outside peak_search_Hz, 8 to 20.5 Hz")
    assert flags_of(tube, {"identification.peak_search_Hz": [8.0, 21.5]}) == {}


def test_the_pole_of_another_mode_is_flagged(tube):
    """The second mode's pole gives the right k, but not for the first mode."""
    row = rows_of(tube, {"identification.peak_search_Hz": [45.0, 65.0]})["lscf"]
    assert row["frequency_Hz"] == pytest.approx(53.9, abs=0.5)
    assert row["flag"].startswith("mode crossing: with this k and c the first mode is at 20.9")


def test_a_stiffness_at_the_end_of_its_range_is_not_resolved(tube):
    """The search by shapes stops at the end; at 3 % from it the stiffness is the range's."""
    key = "identification.stiffness_range_N_per_m"
    near = rows_of(tube, {key: [1.0e3, 1.03e5]})
    for method in ("peak_half", "lscf", "ods", "broadband"):
        assert np.isnan(near[method]["k_N_per_m"])
        assert "at or above the upper end of the range, 1.03e+05 N/m" in near[method]["reason"]
    inside = rows_of(tube, {key: [1.0e3, 1.2e5]})
    assert inside["ods"]["k_N_per_m"] == pytest.approx(STIFFNESS, rel=0.02)


@pytest.mark.parametrize(("share", "at_edge"), [(0.8, False), (0.95, True)])
def test_a_damping_at_the_end_of_its_family_is_not_resolved(tube, share, at_edge):
    """The family ends at 0.9 of the negative c that makes a mode unstable."""
    config, model = tube
    spectra = LinearRecords(config, SENSORS, lambda f: np.ones((31, f.size))).exact("hann")
    reference = reference_tube(model, spectra_layout(config, spectra))
    least = reference.lowest_stable_damping(STIFFNESS) / STABLE_FRACTION
    row = rows_of(tube, c=share * least)["broadband"]
    assert np.isnan(row["c_N_s_per_m"]) == at_edge
    assert ("c is at the edge of the family" in row["flag"]) == at_edge
    assert row["k_N_per_m"] == pytest.approx(STIFFNESS, rel=0.02)


def test_several_supports_have_the_same_guards(tube):
    each = {"identification.groups": "each"}
    flags = flags_of(tube, force_from(20.8) | each)
    assert set(PEAK_METHODS) == set(flags)
    assert flags_of(tube, each) == {}


@pytest.mark.parametrize(("best", "at_edge"), [(-10.0, True), (-4.0, False)])
def test_a_search_says_where_its_bound_of_the_damping_holds_it(best, at_edge):
    """Two supports, the first of which would have a c of `best`; no c may be below -5 N s/m."""
    wanted = np.array([best, 3.0])

    def evaluate(k, c):
        return np.concatenate([np.log(k / STIFFNESS), c - wanted]), np.eye(4)

    search = SupportSearch((1.0e3, 1.0e8), 130.0)
    start = np.log([2.0e5, 2.0e5]), 0.01
    found = search.minimise(evaluate, start, lambda k: np.full(2, -5.0))
    assert list(found.c_at_edge) == [at_edge, False]
    assert found.c[1] == pytest.approx(3.0, abs=1e-3)


def test_a_stiffness_beyond_the_checked_basis_is_flagged():
    assert beyond_checked(9.9e8) == "" and beyond_checked(np.nan) == ""
    (stiff,) = guarded([Estimate("secant", 1.1e9, 0.0)], xr.Dataset(), 18.0, (8.0, 45.0))
    assert stiff.flag.startswith("k is beyond 1e+09 N/m, the stiffest support")
    assert stiff.k == 1.1e9


def test_the_flags_of_some_seeds_reach_the_tables_of_a_study():
    place = {"gap_m": 1e-4, "load_rms_N": 5.0}
    methods = ("lscf", "ods", "broadband")
    sound = [Estimate(method, 1.0e5, 1.0e3, 50.0, 1.0) for method in methods]
    few = guarded(sound, xr.Dataset(), 4.0, (8.0, 45.0))
    tables = [table_rows(sound, place | {"seed": seed}) for seed in range(3)]
    tables.append(table_rows(few, place | {"seed": 3}))
    summary = summary_rows(consistency_rows(tables))
    expected = "1 of 4 seeds: 4 degrees of freedom"
    assert all(row["caution"].startswith(expected) for row in summary)
    (row,) = equivalent_rows(summary)
    assert row["flag"].startswith(expected)
    assert row["k_N_per_m"] == 1.0e5 and row["reason_k"] == ""
    tables[3] = [values | {"flag": "mode crossing"} for values in tables[3]]
    flagged = consistency_dataset(consistency_rows(tables), summary)["flagged"]
    assert flagged.sum() == 3 and flagged.isel(seed=3).sum() == 3
    (clean,) = equivalent_rows(summary_rows(consistency_rows(tables[:3])))
    assert clean["flag"] == ""
    other = clean | {"load_rms_N": 6.0}
    text = success_text("results/any", [row, other])
    assert "Flagged: 1 of 2 cases have a flag in equivalent.csv" in text
    assert "Flagged" not in success_text("results/any", [clean])


def coarse(steps_per_second):
    """The tiny study at 4 N with a coarse step and few modes."""
    values = tiny_values()
    values["grid"] = {"load_rms_N": [4.0], "gap_m": [5.1106e-5], "seeds": 1}
    values["integration"]["steps_per_second"] = steps_per_second
    values["basis"]["free_modes_to_Hz"] = 1000.0
    values["record"]["sampling_frequency_Hz"] = 512
    return check_config(values, "the coarse study")


def tables_of(config):
    """(rows of statistics.csv, consistency.csv, equivalent.csv) of a study of one case."""
    model = reduced_model(config)
    ((_, record),) = simulate_cases(config, model, all_cases(config.grid))
    estimates, _ = identify_case(config, model, record, case_spectra(config, record))
    rows = consistency_rows([table_rows(estimates, record.attrs)])
    return statistics_rows(record), rows, equivalent_rows(summary_rows(rows))


def test_a_step_too_coarse_for_the_contact_is_flagged(tmp_path, reliability):
    """The residual is of order 2 in the step: 10 % at 5120 steps per second, 4 % at 10240."""
    of_record, of_methods, (answer,) = tables_of(coarse(5120))
    assert all("energy balance is open by 0.1" in row["flag"] for row in of_record)
    assert {row["method"] for row in of_methods if not row["flag"]} == {"statistical_linearisation"}
    write_table(of_record, tmp_path / "statistics.csv")
    assert "Flagged: 1 of 1 cases have a flag in statistics.csv" in success_text(tmp_path, [])
    assert np.isnan(answer["k_N_per_m"]) and "energy balance is open" in answer["reason_k"]
    assert "energy balance is open" in answer["flag"]
    of_record, of_methods, (answer,) = tables_of(coarse(10240))
    assert not any("energy" in row["flag"] for row in of_record + of_methods + [answer])
    reliability.fault(
        "time step too coarse for the contact",
        "nothing is identified; statistics.csv, consistency.csv, equivalent.csv and the page say"
        " how far the energy balance is open",
    )


def test_a_diverged_case_ends_its_batch_and_leaves_the_others(reliability):
    """Cases are integrated eight at a time: those before it are there, none is made up."""
    config = coarse(10240)
    calm = [Case(0.1, 2.9e-4, seed) for seed in range(8)]
    beyond = Case(1e100, 5.1106e-5, 0)  # a load that no configuration may have
    stream = simulate_cases(config, reduced_model(config), [*calm, beyond])
    found = [next(stream)[0] for _ in calm]
    assert found == calm
    with pytest.raises(IntegrationError, match="diverged at t = "):
        next(stream)
    reliability.fault(
        "one case of a study diverges",
        "its job ends and names it; other jobs keep their results, no table is made of a part",
    )


def test_an_unresolved_estimate_keeps_its_first_reason():
    lost = unresolved("lscf", "no peak")
    (found,) = guarded([lost], xr.Dataset({"energy_residual": 0.2}), 18.0, (8.0, 45.0))
    assert found.note.startswith("the energy balance is open by 0.2")
    assert found.note.endswith("no peak")


def test_the_page_names_open_energy_balances():
    config, cases = made_up_config(), all_cases(made_up_config().grid)
    worst = {(case.gap_m, case.load_rms_N): 0.04 for case in cases} | {(2.0e-4, 10.0): 0.117}

    def sentences(limit):
        quantity = {"quantity": "potential_energy_residual", "of": ""}
        rows = [
            {"gap_m": case.gap_m, "load_rms_N": case.load_rms_N, "seed": case.seed}
            | quantity
            | {"value": min(worst[case.gap_m, case.load_rms_N], limit)}
            for case in cases
        ]
        return energy_sentences(config, StudyStatistics(cases, rows))

    (sentence,) = sentences(1.0)
    assert sentence.startswith("Not to be used: in 1 of 6 pairs of load and gap the energy balance")
    assert "(11.7 % at 10 N RMS and a gap of 0.2 mm)" in sentence
    assert sentences(0.05) == []


@pytest.mark.parametrize(("rate", "accepted"), [(5120, 0.05), (20480, 0.01875)])
def test_no_step_makes_a_lost_energy_balance_acceptable(rate, accepted):
    values = tiny_values()["integration"] | {"scheme": "exact", "steps_per_second": rate}
    assert limits(SimpleNamespace(**values))["potential_energy_residual"] == accepted
