"""Cases: ids that survive a changed grid, loads that say what was simulated, random streams that
depend on the seed only.
"""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.config.reading import load_config
from vibroimpact.study.cases import (
    CASES_PER_JOB,
    Case,
    all_cases,
    batches,
    case_from_id,
    cases_of_files,
    cases_of_load,
    load_values,
    value_text,
)

STUDY = Path(__file__).parents[2] / "config" / "study.yaml"


def grid(loads, gaps=(2.8886e-4, 5.1106e-5), seeds=2):
    """A grid as the configuration gives it."""
    return SimpleNamespace(load_rms_N=loads, gap_m=gaps, seeds=seeds)


def test_the_default_grid_is_24_loads_by_3_gaps_by_4_seeds():
    cases = all_cases(load_config(STUDY).grid)
    assert len(cases) == 288
    assert len({case.id for case in cases}) == 288
    assert cases[0] == Case(0.05, 2.8886e-4, 0)
    assert cases[-1] == Case(20.0, 5.1106e-5, 3)


def test_loads_are_log_spaced_to_the_digits_of_their_ids():
    loads = load_values(load_config(STUDY).grid)
    assert (loads[0], loads[-1]) == (0.05, 20.0)
    steps = np.diff(np.log(loads))
    assert steps == pytest.approx(np.log(400.0) / 23, rel=1e-4)
    assert all(float(value_text(load)) == load for load in loads)


def loads_of(batches):
    """The loads of each batch, by its name."""
    return {name: sorted({case.load_rms_N for case in cases}) for name, cases in batches.items()}


def test_half_decade_of_a_load_ignores_the_other_loads():
    assert loads_of(batches(grid((20.0, 0.05, 1.0, 3.1, 3.17, 10.0, 0.999)), 2)) == {
        "from_0.05": [0.05],
        "from_0.999": [0.999],
        "from_1": [1.0, 3.1],
        "from_3.17": [3.17],
        "from_10": [10.0, 20.0],
    }
    study = load_config(STUDY).grid
    assert [len(loads) for loads in loads_of(batches(study, 2)).values()] == [3, 5, 4, 4, 5, 3]


def test_the_default_study_simulates_one_load_per_job():
    study = load_config(STUDY).grid
    assert list(batches(study, 10).values()) == [
        cases_of_load(study, load) for load in load_values(study)
    ]


def test_batches_hold_every_case_once_in_order():
    for loads, gaps, seeds in (
        ((0.5, 4.0), (1e-4, 5e-5), 3),
        (tuple(np.geomspace(0.05, 20.0, 700)), (1e-4, 5e-5), 3),
        ((1.0, 1.0 + 1e-15), (1e-4,), 5000),
        (tuple(1.0 + 1e-12 * np.arange(2000)), (1e-4,), 1),
    ):
        whole = grid(loads, gaps, seeds)
        found = batches(whole, 10).values()
        assert sorted(case for cases in found for case in cases) == sorted(all_cases(whole))
        assert all(cases == sorted(cases, key=all_cases(whole).index) for cases in list(found)[:3])


def test_jobs_grow_with_the_cases_only_where_jobs_would_be_long():
    jobs = {
        count: batches(grid(tuple(np.geomspace(0.05, 20.0, count)), (1e-4,), 1), 10)
        for count in (24, 240, 2400, 100_000)
    }
    tenths = 28  # of decades, from -1.301 to 1.301
    assert [len(jobs[count]) for count in (24, 240, 2400)] == [24, tenths, tenths]
    longest = max(len(cases) for cases in jobs[100_000].values())
    assert CASES_PER_JOB / 2 < longest <= CASES_PER_JOB
    assert len(jobs[100_000]) <= tenths + 100_000 / (CASES_PER_JOB / 2)


@pytest.mark.parametrize("count", [24, 2400, 40_000])
def test_an_added_load_changes_the_batch_it_falls_into(count):
    loads = tuple(np.geomspace(0.05, 20.0, count))
    before = batches(grid(loads, (1e-4,), 1), 10)
    after = batches(grid((*loads, 0.777), (1e-4,), 1), 10)
    changed = [name for name, cases in after.items() if before.get(name) != cases]
    assert len(changed) == 1 and 0.777 in [case.load_rms_N for case in after[changed[0]]]


def test_a_batch_holds_no_more_cases_than_a_job_may_take():
    whole = grid(tuple(np.geomspace(0.05, 20.0, 2400)), (1e-4,), 1)
    assert max(len(cases) for cases in batches(whole, 2, 100).values()) <= 100


def test_an_added_seed_changes_the_last_block_of_seeds():
    before, after = (batches(grid((0.5, 4.0), (1e-4,), seeds), 10) for seeds in (100, 101))
    changed = {name for name, cases in after.items() if before[name] != cases}
    assert changed == {"from_0.5_seed_64", "from_4_seed_64"}


def test_an_id_reads_back_as_exactly_its_case():
    for case in [
        Case(0.1 + 0.2, 5.1106e-05, 0),
        Case(20.0, 2.0**-13, 17),
        Case(1e-7, 1e-22, 3),
        Case(123456789.125, 0.01, 1),
    ]:
        assert case_from_id(case.id) == case


def test_ids_are_made_of_values():
    assert Case(0.5, 2.8886e-4, 1).id == "load_0.5_gap_0.00028886_seed_1"
    assert Case(20.0, 5.1106e-5, 0).id == "load_20_gap_5.1106e-05_seed_0"


def test_an_added_load_gap_or_seed_changes_no_other_id():
    before = {case.id for case in all_cases(grid((0.5, 4.0)))}
    for grown in (
        grid((0.1, 0.5, 4.0)),
        grid((0.5, 4.0), gaps=(1e-4, 2.8886e-4, 5.1106e-5)),
        grid((0.5, 4.0), seeds=3),
    ):
        after = {case.id for case in all_cases(grown)}
        assert before < after


def test_malformed_case_id_is_refused():
    for text in ("load_1_gap_2", "load_1_gap_2_seed_x", "load_1_gap_2_seed_0.nc", ""):
        with pytest.raises(ValueError, match="should look like load_0.5_gap"):
            case_from_id(text)


def test_the_cases_of_a_load_are_those_of_the_grid():
    whole = grid((0.5, 4.0))
    assert [case for load in (0.5, 4.0) for case in cases_of_load(whole, load)] == all_cases(whole)


def test_files_named_after_cases_give_their_cases():
    cases = all_cases(grid((0.5, 1e-7)))
    assert cases_of_files([f"results/a.b/records/{case.id}.nc" for case in cases]) == cases
    with pytest.raises(ValueError, match="'model' is not a case id"):
        cases_of_files(["results/model.nc"])
