"""Cases: ids that survive a changed grid, loads that say what was simulated, random streams that
depend on the seed only.
"""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.config.reading import load_config
from vibroimpact.study.cases import (
    Case,
    all_cases,
    case_from_id,
    cases_of_load,
    ids_of_load,
    load_values,
    loads_by_half_decade,
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


def test_half_decade_of_a_load_ignores_the_other_loads():
    batches = loads_by_half_decade(grid((20.0, 0.05, 1.0, 3.1, 3.17, 10.0, 0.999)))
    assert batches == {
        "from_0.0316": ["0.05"],
        "from_0.316": ["0.999"],
        "from_1": ["1", "3.1"],
        "from_3.16": ["3.17"],
        "from_10": ["10", "20"],
    }
    assert [len(loads) for loads in loads_by_half_decade(load_config(STUDY).grid).values()] == [
        3,
        5,
        4,
        4,
        5,
        3,
    ]


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
    assert [name for load in ("0.5", "4") for name in ids_of_load(whole, load)] == [
        case.id for case in all_cases(whole)
    ]
