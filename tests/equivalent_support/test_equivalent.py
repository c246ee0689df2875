"""k and c at any load and gap of a study: read, interpolated, or refused."""

import dataclasses

import numpy as np
import pytest

from tests.support.study_tables import (
    FACTORS,
    GAPS,
    LOADS,
    disputed_study,
    k_law,
    made_up_study,
    summary_rows,
)
from vibroimpact import EquivalentError, equivalent
from vibroimpact.config.reading import changed_config
from vibroimpact.config.stage_keys import answer_digest
from vibroimpact.equivalent_support.answer import NOT_MOVED
from vibroimpact.equivalent_support.answer_text import as_plain, as_text
from vibroimpact.equivalent_support.study_tables import (
    RECOMMENDED,
    SUMMARY,
    recommended_rows_of,
    require_tables_of,
    summary_rows_of,
)
from vibroimpact.io.records import read_table, write_table
from vibroimpact.study.equivalent_table import EQUIVALENT_COLUMNS, equivalent_rows
from vibroimpact.study.run_files import write_run_files

K_COLUMNS = ("k_median", "k_low", "k_high")
LOST = dict.fromkeys(K_COLUMNS, np.nan)


def recommended(direction, agreement, reason, **values):
    """A row of equivalent.csv of all supports; agreement and reason are those of k and c."""
    row = dict.fromkeys(EQUIVALENT_COLUMNS, np.nan)
    row |= {"group": "all", "direction": direction, "flag": ""}
    row |= {"agreement_k": agreement, "agreement_c": agreement}
    return row | {"reason_k": reason, "reason_c": reason} | values


@pytest.fixture
def study(tmp_path, study_model):
    """The folder of a study whose k is a power of load over gap."""
    return made_up_study(tmp_path, study_model)


def test_a_case_of_the_grid_is_the_table_itself(study):
    (group,) = equivalent(study, 4.0, 1.0e-4).groups
    assert group.k.value == pytest.approx(k_law(4.0e4), rel=1e-12)  # lscf, the median of three
    ends = 0.9 * 0.96 * k_law(4.0e4), 1.2 * 1.02 * k_law(4.0e4)
    assert (group.k.low, group.k.high) == pytest.approx(ends)
    assert group.c.value == pytest.approx(1.0e-3 * 1.01 * k_law(4.0e4))  # the shape has none
    assert (group.direction, group.supports) == ("y", ("left", "right"))
    assert group.how == "a case of the study: 4 N RMS at 0.1 mm"
    assert group.secant_k == pytest.approx(0.9 * k_law(4.0e4))
    assert {item.method for item in group.methods} == set(FACTORS)


@pytest.mark.parametrize("table", ["equivalent.csv", "consistency_summary.csv"])
def test_tables_of_another_configuration_are_refused(study, study_config, table, reliability):
    values = study_config.model_dump(mode="json")
    if table == "equivalent.csv":
        write_table(equivalent_rows(summary_rows_of(study)), study / table)
    own = {"config_digest": answer_digest(values)}
    write_table([row | own for row in read_table(study / table)], study / table)
    write_run_files(study, values, ["snakemake"])
    assert equivalent(study, 4.0, 1.0e-4).groups[0].k.resolved
    require_tables_of(study, study_config, "study.yaml")
    other = changed_config(study_config, {"spectra.overlap": 0.5})
    with pytest.raises(EquivalentError, match=f"{table}: is of another .* other.yaml: run"):
        require_tables_of(study, other, "other.yaml")
    values["spectra"]["overlap"] = 0.5  # another run has begun and was killed
    write_run_files(study, values, ["snakemake"])
    with pytest.raises(EquivalentError, match=rf"{table}: is of another configuration than .*yaml"):
        equivalent(study, 4.0, 1.0e-4)
    reliability.fault(
        "a run of a changed configuration is killed, and the old tables stand",
        "`vibroimpact equivalent` refuses them",
    )
    values["spectra"]["overlap"], values["overlay"]["noise"] = 0.65, 0.3  # of a figure alone
    write_run_files(study, values, ["snakemake"])
    assert equivalent(study, 4.0, 1.0e-4).groups[0].k.resolved


@pytest.mark.parametrize("table", [SUMMARY, RECOMMENDED])
def test_a_table_of_an_older_version_is_refused(study, table):
    summary = read_table(study / SUMMARY)
    write_table(equivalent_rows(summary), study / RECOMMENDED, EQUIVALENT_COLUMNS)
    columns = [name for name in read_table(study / table)[0] if name != "flag"]
    rows = [{name: row[name] for name in columns} for row in read_table(study / table)]
    write_table(rows, study / table, columns)
    with pytest.raises(EquivalentError, match=f"{table}: lacks the columns flag, .* run the study"):
        equivalent(study, 4.0, 1.0e-4)


def test_a_power_law_is_interpolated_exactly_at_any_gap(study):
    for load, gap in ((3.1, 1.7e-4), (0.9, 0.5e-4), (20.0, 1.0e-3)):
        (group,) = equivalent(study, load, gap).groups
        assert group.k.value == pytest.approx(k_law(load / gap), rel=1e-9)
        assert group.agreement_k == "agree"


def test_the_answer_says_what_it_was_interpolated_from(study):
    (group,) = equivalent(study, 3.0, 1.5e-4).groups  # 2e4 N/m: on a load of gap 0.1 mm
    assert group.how == (
        "interpolated between 2.00e+04 and 2.00e+04 N/m of load over gap, from gaps 0.3 and 0.1 mm;"
        " collapse within 0 %"
    )
    assert group.agreeing == (pytest.approx(2.0 / 3.0e-4), pytest.approx(8.0e4))
    (alone,) = equivalent(study, 5.0, 1.0e-4).groups  # beyond what the wide gap reaches
    assert "from gap 0.1 mm; no other gap reaches there" in alone.how


def test_a_gap_that_is_off_widens_the_interval(tmp_path, study_model):
    rows = summary_rows()
    for row in rows:
        row |= {name: 1.3 * row[name] for name in K_COLUMNS if row["gap_m"] == GAPS[1]}
    study = made_up_study(tmp_path, study_model, rows)
    (group,) = equivalent(study, 2.2, 1.0e-4).groups
    assert "collapse within 30 %" in group.how
    assert group.k.high > 1.29 * 1.2 * k_law(2.2e4)


@pytest.mark.parametrize("load, gap", [(9.0, 1.0e-4), (1.0, 3.1e-4), (1.0, 4.0e-3)])
def test_nothing_is_extrapolated(study, load, gap):
    with pytest.raises(EquivalentError, match="nothing is extrapolated. The nearest case is") as no:
        equivalent(study, load, gap)
    assert "to grid.load_rms_N in the configuration of study" in str(no.value)
    assert "snakemake -j2 --configfile" in str(no.value)


def test_the_sentence_names_the_file_of_the_study(tmp_path, monkeypatch, study_model):
    folder = tmp_path / "results" / "mine"
    folder.mkdir(parents=True)
    made_up_study(folder, study_model)
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "a.yaml").write_text("study: mine\n")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(EquivalentError, match="8 N RMS at 0.0001 m. Add the load 9 to") as no:
        equivalent("mine", 9.0, 1.0e-4)
    assert "grid.load_rms_N in config/a.yaml (written as a list" in str(no.value)
    assert "--configfile config/a.yaml" in str(no.value)


def test_what_is_not_resolved_has_a_reason_and_no_number(study):
    (group,) = equivalent(study, 1.0, 3.0e-4).groups
    assert not group.k.resolved and group.agreement_k == "unresolved"
    assert group.reason_k == "no method resolves k; LSCF pole: no value"
    assert group.secant_k > 0.0 and group.agreeing[0] == pytest.approx(2.0 / 3.0e-4)
    answer = equivalent(study, 1.0, 3.0e-4)
    assert len(answer.unresolved) == 1  # k and c for one reason
    assert "k   unresolved: no method resolves k" in as_text(answer)
    assert as_plain(answer)["groups"][0]["k"]["value"] is None


def test_a_fixed_gap_is_interpolated_in_load_alone(tmp_path, study_model):
    laws = study_model.contact_laws.with_columns(gap=1.0e-4)
    model = dataclasses.replace(study_model, contact_laws=laws)
    study = made_up_study(tmp_path, model)
    answer = equivalent(study, 3.0, 3.0e-4)
    assert not answer.homogeneous and "a gap fixed in m of supports left, right" in answer.notes[0]
    assert answer.groups[0].how == "interpolated between 2 and 4 N RMS at gap 0.3 mm"
    assert answer.groups[0].k.value == pytest.approx(k_law(1.0e4), rel=1e-9)
    with pytest.raises(EquivalentError, match="can not be interpolated, because the model has a"):
        equivalent(study, 3.0, 2.0e-4)
    with pytest.raises(EquivalentError, match="outside the loads of study"):
        equivalent(study, 9.0, 3.0e-4)


def test_a_study_without_recommended_values_gets_them(tmp_path):
    rows = summary_rows(group="outer", direction="x", reason="too short")
    write_table(rows, tmp_path / "consistency_summary.csv")
    found = recommended_rows_of(tmp_path, summary_rows_of(tmp_path))
    assert {(row["group"], row["direction"]) for row in found} == {("outer", "x")}
    (case,) = (row for row in found if (row["gap_m"], row["load_rms_N"]) == (1.0e-4, 2.0))
    assert (case["agreement_k"], case["agreement_c"]) == ("agree", "agree")
    (blind,) = (row for row in found if np.isnan(row["k_N_per_m"]))
    assert blind["reason_k"] == "no method resolves k; LSCF pole: too short"


def test_the_recommended_table_of_the_study_is_used(study):
    row = recommended("y", "spread", "", group="left", agreement_c="unresolved")
    row |= {"reason_c": "the record is short", "k_N_per_m": 7.0e4, "k_low": 6.0e4, "k_high": 8.0e4}
    row |= {"secant_c_N_s_per_m": 30.0}
    cases = [{"gap_m": gap, "load_rms_N": load} for gap in GAPS for load in (1.0, 8.0)]
    write_table([row | case for case in cases], study / "equivalent.csv")
    (group,) = equivalent(study, 3.0, 1.0e-4).groups
    assert (group.group, group.supports) == ("left", ("left",))
    assert (group.k.value, group.k.low, group.k.high) == pytest.approx((7.0e4, 6.0e4, 8.0e4))
    assert (group.agreement_k, group.secant_c) == ("spread", pytest.approx(30.0))
    assert group.reason_c.startswith("the record is short") and group.agreeing is None


@pytest.mark.parametrize("group, supports", [("right", ("right",)), ("left+right", None)])
def test_a_group_is_named_after_its_supports(tmp_path, study_model, group, supports):
    rows = summary_rows(group=group, direction="y", verdict_k="agree", verdict_c="agree")
    study = made_up_study(tmp_path, study_model, rows)
    (found,) = equivalent(study, 3.0, 1.0e-4).groups
    assert found.supports == (supports or ("left", "right"))


@pytest.mark.parametrize("group, direction", [("middle", "y"), ("left", "z"), ("left", "normal")])
def test_tables_of_another_model_are_refused(tmp_path, study_model, group, direction):
    rows = summary_rows(group=group, direction=direction, verdict_k="agree", verdict_c="agree")
    study = made_up_study(tmp_path, study_model, rows)
    with pytest.raises(EquivalentError, match="belong to different studies"):
        equivalent(study, 3.0, 1.0e-4)


def test_a_direction_that_is_not_driven_says_so(study):
    numbers = ("k_N_per_m", "k_low", "k_high", "c_N_s_per_m", "c_low", "c_high")
    moved = recommended("y", "agree", "", **dict.fromkeys(numbers, 5.0e4))
    both = moved, recommended("x", "unresolved", NOT_MOVED)
    cases = [{"gap_m": gap, "load_rms_N": load} for gap in GAPS for load in LOADS]
    write_table([row | case for case in cases for row in both], study / "equivalent.csv")
    answer = equivalent(study, 3.0, 1.5e-4)
    assert answer.groups[0].k.value == pytest.approx(5.0e4) and answer.unresolved == []
    assert not answer.groups[1].moved
    assert "No values for 'all' along x: the force does not move the supports" in as_text(answer)


def test_two_methods_are_enough_for_k(tmp_path, study_model):
    """Where the shape gives none, k is the mean of the other two, and the answer says so."""
    rows = [row | LOST if row["method"] == "ods" else row for row in summary_rows()]
    study = made_up_study(tmp_path, study_model, rows)
    answer = equivalent(study, 4.0, 1.0e-4)
    assert answer.groups[0].k.value == pytest.approx(1.01 * k_law(4.0e4))
    assert "methods: two of three resolve it" in as_text(answer)
    assert answer.unresolved == []
    assert answer.warnings == [
        "k of 'all' along y: two of three methods resolve k; deflection shape: no value"
    ]


@pytest.mark.parametrize("load", [4.0, 3.1])
def test_a_disputed_value_is_taken_only_when_asked_for(tmp_path, study_model, load):
    study, k = disputed_study(tmp_path, study_model), k_law(load / 1.0e-4)
    answer = equivalent(study, load, 1.0e-4)
    (group,) = answer.groups
    assert not group.k.resolved and group.agreement_k == "differ" and answer.disputed
    assert "the methods differ: LSCF pole" in answer.unresolved[0]
    assert "k   no recommended value: the methods differ: LSCF pole" in as_text(answer)
    taken = answer.anyway("broadband")
    assert taken.groups[0].k.value == pytest.approx(1.02 * k)
    assert taken.groups[0].c.value == pytest.approx(1.02e-3 * k, rel=0.15)  # c is linear in between
    assert taken.unresolved == [] and not taken.disputed
    assert taken.warnings[0].startswith(
        "k of 'all' along y is that of the broadband PSD alone, taken anyway: the methods differ"
    )
    assert "WARNING: k of 'all' along y is that of the broadband PSD alone" in as_text(taken)
    assert as_plain(taken)["warnings"] == taken.warnings
    shape = answer.anyway("ods")
    assert shape.groups[0].k.resolved and len(shape.unresolved) == 1  # a shape has no c
    assert answer.anyway("peak_none") == answer


def test_an_upper_bound_is_an_answer(tmp_path, study_model):
    text = "k < 2.45 kN/m: the tube hardly touches, 0.3 % of the time"
    row = recommended("y", "unresolved", text, gap_m=1.0e-4, contact_fraction=0.003)
    bounds = ((1.0, 2.45e3), (2.0, 2.6e3))
    table = [row | {"load_rms_N": load, "k_bound": bound} for load, bound in bounds]
    study = made_up_study(tmp_path, study_model)
    write_table(table, study / "equivalent.csv")
    answer = equivalent(study, 1.0, 1.0e-4)
    (group,) = answer.groups
    assert group.bounded and group.bound == 2.45e3 and answer.unresolved == []
    assert f"  {text}\n  c   no value: k has only a bound" in as_text(answer)
    between = equivalent(study, 1.5, 1.0e-4).groups[0]
    assert between.bound == 2.6e3 and between.reason_k.startswith("k < 2.6 kN/m: ")
    assert answer.anyway("lscf") == answer
    assert as_plain(answer)["groups"][0]["bound"] == 2.45e3


def test_questions_without_sense_are_refused(study, tmp_path):
    for load, gap in ((0.0, 1e-4), (1.0, -1e-4), (float("nan"), 1e-4)):
        with pytest.raises(EquivalentError, match="give a positive number"):
            equivalent(study, load, gap)
    with pytest.raises(EquivalentError, match="is no finished study"):
        equivalent(tmp_path / "nowhere", 1.0, 1e-4)


def test_the_load_to_add_reaches_the_level_at_a_gap_of_the_study(study):
    """13 N at 0.123 mm is 1.057e5 N/m, which is 10.57 N at 0.1 mm; 1 N at 1 mm, 0.3 N at 0.3 mm."""
    for load, gap, wanted in ((13.0, 1.23e-4, "10.6"), (1.0, 1.0e-3, "0.3")):
        with pytest.raises(EquivalentError, match=f"Add the load {wanted} to grid.load_rms_N"):
            equivalent(study, load, gap)


def test_one_resolved_gap_of_several_is_a_chance_selection(tmp_path, study_model):
    """At 1e4 N/m the wide gap is blind below 2 N: alone it does not count against the other."""
    rows = summary_rows()
    for row in rows:
        row |= LOST if row["gap_m"] == GAPS[1] and row["load_rms_N"] < 8.0 else {}
    study = made_up_study(tmp_path, study_model, rows)
    (group,) = equivalent(study, 1.2, 1.0e-4).groups  # one of two
    assert group.how.endswith("from gap 0.1 mm; not resolved at 0.3 mm")
    assert group.k.value == pytest.approx(k_law(1.2e4), rel=1e-9)
    third = [row | {"gap_m": 2.9e-4, "load_rms_N": row["load_rms_N"] * 2.9 / 3.0} for row in rows]
    rows += [row for row, old in zip(third, rows, strict=True) if old["gap_m"] == GAPS[1]]
    (group,) = equivalent(made_up_study(tmp_path, study_model, rows), 1.2, 1.0e-4).groups
    assert not group.k.resolved and group.agreement_k == "unresolved"  # one of three
