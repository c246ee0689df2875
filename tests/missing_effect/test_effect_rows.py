"""The effects of a verdict as rows: parameters in their units, with intervals."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.effects.places import STOP
from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.missing_effect.rows import bounds, effects_of

SCALES = {"gap": 2.0e-4, "one": 1.0, "mass": 1.0}


def chosen(name, unit=0.8):
    """A Decision, in the parts that are looked at, for a candidate at normalised parameters."""
    candidate = candidate_named(name)
    row = np.full(len(candidate.effect.parameters), unit)
    interval = np.stack([row - 0.05, row + 0.05], axis=1)
    found = SimpleNamespace(candidate=candidate, unit=row, interval=interval)
    return SimpleNamespace(chosen=found)


@pytest.mark.parametrize(
    ("location", "nominal"), [("left", 3.0e-4), ("right", 5.0e-4), ("all", None)]
)
def test_gap_is_given_in_metres_of_the_model_clearance(location, nominal):
    laws = SimpleNamespace(gap=np.array([np.nan, np.nan, 5.0e-4, 9.0e-4]))
    model = SimpleNamespace(
        support_names=("left", "right", STOP),
        support_of_point=np.array([0, 0, 1, 2]),
        gap_factor=np.array([1.5, 1.5, 1.0, 1.0]),
        contact_laws=laws,
    )
    prepared = SimpleNamespace(adopted=None, scales=SCALES)
    (row,) = effects_of(prepared, chosen(f"gap@{location}"), model)
    factor = row["parameters"]["gap_factor"]["value"]
    assert ("gap" in row["parameters"]) == (nominal is not None)
    if nominal is not None:
        assert row["parameters"]["gap"]["value"] == pytest.approx(nominal * factor)


def test_two_linear_effects_are_two_rows():
    adopted = {
        "name": "added_mass@apex+sensor_gain@apex_y",
        "unit": [0.4, 0.6],
        "gain": 90.0,
        "interval": [[0.39, 0.41], [0.55, 0.65]],
    }
    prepared = SimpleNamespace(adopted=adopted, scales=SCALES)
    told = effects_of(prepared, SimpleNamespace(chosen=None), None)
    assert [(row["id"], row["location"], list(row["parameters"])) for row in told] == [
        ("added_mass", "apex", ["mass"]),
        ("sensor_gain", "apex_y", ["factor"]),
    ]
    gain = told[1]["parameters"]["factor"]
    assert gain["value"] == pytest.approx(0.25 * 16.0**0.6)
    assert gain["low"] < gain["value"] < gain["high"]


def test_what_stands_in_place_of_a_linear_effect_is_alone():
    adopted = {"name": "added_mass@apex", "unit": [0.4], "interval": [[0.39, 0.41]]}
    prepared = SimpleNamespace(adopted=adopted, scales=SCALES)
    alone = effects_of(prepared, chosen("dry_friction@all@alone"), None)
    assert [row["id"] for row in alone] == ["dry_friction"]
    beside = effects_of(prepared, chosen("dry_friction@all"), None)
    assert [row["id"] for row in beside] == ["added_mass", "dry_friction"]


def test_estimate_at_the_end_of_its_range_is_told():
    assert bounds(chosen("dry_friction@all")) == []
    (row,) = bounds(chosen("dry_friction@all", 0.99))
    assert row["level"] == "warn" and "mu of dry_friction@all is at a bound" in row["message"]
