"""The check of quick verdicts fails where a verdict is wrong."""

import pytest

from tests.discrepancy_results import made_up_verdict
from vibroimpact.acceptance.quick_check import CHECKS, table


def verdict(kind, *sets, factor=None):
    """A Verdict in the parts that are looked at."""
    factors = {
        "gap_factor": {"value": factor, "unit": "1", "low": factor, "high": factor},
    }
    found = {"id": "gap", "location": "all", "parameters": factors}
    return made_up_verdict(
        kind,
        ambiguity_set=[list(row) for row in sets],
        effects=[],
        most_probable=[] if factor is None else [found],
    )


@pytest.mark.parametrize(
    "name, said, right",
    [
        ("nothing", verdict("none"), True),
        ("nothing", verdict("unknown"), False),
        ("nothing", verdict("named", ["gap"]), False),
        ("common_gain", verdict("ambiguous", ["gap"], ["sensor_gain"]), True),
        ("common_gain", verdict("named", ["gap"]), False),
        ("force_gain", verdict("named", ["sensor_gain"]), True),
        ("force_gain", verdict("ambiguous", ["gap"], ["sensor_gain"]), False),
        ("contact_damping", verdict("ambiguous", ["hunt_crossley"], ["contact_damping"]), True),
        ("contact_damping", verdict("named", ["dry_friction"]), False),
        ("swapped", verdict("ambiguous", ["gap"], ["sensor_gain"], factor=0.63), True),
        ("swapped", verdict("ambiguous", ["gap"], ["sensor_gain"], factor=1.6), False),
        ("swapped", verdict("ambiguous", ["gap"], ["sensor_gain"]), False),
    ],
)
def test_wrong_verdict_has_its_reasons(name, said, right):
    (row,) = table({name: said})
    assert row["right"] == right and bool(row["faults"]) != right


def test_suite_checks_hide_known_effects():
    from vibroimpact_truth.hidden import EFFECTS
    from vibroimpact_truth.measure import INSTRUMENTS

    assert {effect for check in CHECKS.values() for effect, _ in check.hidden} <= {
        *EFFECTS,
        *INSTRUMENTS,
    }


def test_model_only_effects_are_in_its_configuration(study_config):
    plain = study_config.model_dump(mode="json")
    assert CHECKS["nothing"].values(plain) == plain
    assert {support["gap_factor"] for support in CHECKS["swapped"].values(plain)["supports"]} == {
        1.6
    }
