"""The verdict: what is written is valid, comes back unchanged, and keeps its schema."""

import json
from pathlib import Path

import jsonschema
import pytest
from pydantic import ValidationError

from tests.support.discrepancy_results import made_up_verdict
from vibroimpact.diagnosis import verdict
from vibroimpact.diagnosis.run_cost import StageCosts
from vibroimpact.diagnosis.verdict.content import (
    CONCLUSIONS,
    Estimate,
    Verdict,
    not_testable,
    read_verdict,
    write_verdict,
)
from vibroimpact.io.records import RecordError

SCHEMA = Path(verdict.__file__).with_name("verdict.schema.json")

# As the two engines write them, with the keys in their order: a clearance states its unit first.
HEAD = """{
 "verdict": "none",
 "effects": [],
 "ambiguity_set": [],
 "ranking": [
  {
   "ids": [
    "gap"
   ],
   "heldout_score": null,
   "closed_fraction": 1,
   "location": "all"
  }
 ],
 "next_measurement": null,
 "broken_invariances": [
  "T2"
 ],
 "regions": [],
 "misfit": {
  "fit": null,
  "holdout": {
   "before_dB": 1.6662187912446977,
   "after_dB": 0.0,
   "floor_dB": 2,
   "closed_fraction": null
  }
 },
 "p_global_before": 2.1078014774627546e-99,
 "p_global_after": 1.0,
 "checks": [],
 "seconds": 61.357114249000006,
 "simulations": 592,
"""
FILES = {
    "records": HEAD
    + """ "most_probable": [
  {
   "id": "gap",
   "location": "all",
   "parameters": {
    "gap_factor": {
     "value": 1.2,
     "low": 1.1,
     "high": 1.3,
     "unit": "1"
    },
    "gap": {
     "unit": "m",
     "value": 0.0003,
     "low": 0.0002,
     "high": 0.0004
    }
   }
  }
 ],
 "provenance": {
  "source_digest": "eb31c091b8e7543c"
 }
}""",
    "no provenance": HEAD[:-2] + "\n}",
}


@pytest.mark.parametrize("text", FILES.values(), ids=FILES)
def test_a_file_that_is_read_and_written_keeps_its_bytes(text, tmp_path):
    (tmp_path / "first.json").write_text(text)
    verdict = read_verdict(tmp_path / "first.json")
    write_verdict(verdict, tmp_path / "second.json")
    assert (tmp_path / "second.json").read_text() == text
    assert verdict.p_global_before == 2.1078014774627546e-99


def json_schema():
    """The JSON schema (draft 2020-12) of verdict.json."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **Verdict.model_json_schema(),
    }


def test_the_committed_schema_is_the_schema():
    assert SCHEMA.read_text(encoding="utf-8") == json.dumps(json_schema(), indent=2) + "\n"


@pytest.mark.parametrize("conclusion", CONCLUSIONS)
def test_what_is_written_keeps_the_schema(conclusion, tmp_path):
    jsonschema.Draft202012Validator.check_schema(json_schema())
    write_verdict(made_up_verdict(conclusion), tmp_path / "verdict.json")
    jsonschema.validate(json.loads((tmp_path / "verdict.json").read_text()), json_schema())


@pytest.mark.parametrize(
    ("changes", "place"),
    [
        ({"verdict": "perhaps"}, "verdict"),
        ({"misfits": {}}, "misfits"),
        ({"seconds": "long"}, "seconds"),
        ({"checks": [{"check": "units", "level": "bad"}]}, "checks.0.level"),
        ({"effects": [{"id": "gap", "location": "all", "parameters": {}}]}, "effects must be"),
        ({"ambiguity_set": [["gap"]]}, "ambiguity_set must be empty"),
    ],
)
def test_content_outside_the_schema_is_refused(changes, place):
    with pytest.raises(ValidationError, match=place):
        made_up_verdict("none", **changes)
    if "must be" not in place:  # a rule between keys, which the JSON schema does not state
        values = made_up_verdict("none").to_values() | changes
        assert list(jsonschema.Draft202012Validator(json_schema()).iter_errors(values))


def test_a_content_changed_after_it_was_made_is_not_written(tmp_path):
    broken = made_up_verdict("none").model_copy(update={"simulations": "many"})
    with pytest.raises(ValidationError, match="simulations"):
        write_verdict(broken, tmp_path / "verdict.json")
    assert not (tmp_path / "verdict.json").exists()


@pytest.mark.parametrize("text", ["{", "{}", '{"verdict": "none"}'])
def test_a_file_that_is_no_verdict_is_refused_by_name(text, tmp_path):
    (tmp_path / "verdict.json").write_text(text)
    with pytest.raises(RecordError, match="verdict.json: is no verdict"):
        read_verdict(tmp_path / "verdict.json")


def test_numbers_that_are_not_finite_are_null():
    estimate = Estimate.from_values({"value": 1.0, "unit": "m", "low": -float("inf"), "high": None})
    assert estimate.low is None


def test_a_refused_campaign_gives_a_whole_verdict():
    row = {"check": "c", "level": "refuse", "record": None, "channel": None, "message": "No."}
    verdict = not_testable([row], {}, "Record two levels.", StageCosts().total())
    assert verdict.verdict == "not_testable" and verdict.checks[0].message == "No."
    required = {name for name, field in Verdict.model_fields.items() if field.is_required()}
    assert required <= set(verdict.to_values())
