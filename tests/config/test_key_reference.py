"""The declaration of the configuration, and the JSON schema and key reference made from it."""

import re
from pathlib import Path
from typing import Annotated

import jsonschema
import pytest
import yaml
from pydantic import TypeAdapter

from vibroimpact.config.declared_keys import examples_of, meaning_of, unit_of
from vibroimpact.config.json_schema import json_schema
from vibroimpact.config.key_reference import declared_sections, markdown
from vibroimpact.config.measured_structure import MeasuredStructure
from vibroimpact.config.problems import members
from vibroimpact.config.quantities import Section
from vibroimpact.config.schema import Config

ROOT = Path(__file__).parents[2]
CONFIGS = sorted(
    file for file in (ROOT / "config").rglob("*.yaml") if "\nstudy:" in f"\n{file.read_text()}"
)


def sections_of(section):
    """A section and all those inside it."""
    found = {section}
    for field in section.model_fields.values():
        for member in members(field.annotation):
            if isinstance(member, type) and issubclass(member, Section) and member not in found:
                found |= sections_of(member)
    return found


FIELDS = [
    pytest.param(name, field, id=f"{section.__name__}.{name}")
    for section in sorted(sections_of(Config) | {MeasuredStructure}, key=lambda each: each.__name__)
    for name, field in section.model_fields.items()
]


@pytest.mark.parametrize(("name", "field"), FIELDS)
def test_every_key_has_a_meaning_and_a_valid_example(name, field):
    assert field.description and field.description.endswith(".")
    holds = members(field.annotation)
    if not any(isinstance(each, type) and issubclass(each, Section) for each in holds):
        assert examples_of(field)
    checked = TypeAdapter(
        Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
    )
    for example in examples_of(field):
        checked.validate_python(example)
    unit_of(name, field)  # raises where a number has none


def test_every_section_says_what_it_is():
    for section in sections_of(Config):
        assert meaning_of(section).endswith("."), section
        assert section.__doc__ is not Section.__doc__, section


def keys_in(value, place=""):
    """The dotted keys in a mapping as YAML gives it; a list is left out of the path."""
    if isinstance(value, list):
        return {key for each in value for key in keys_in(each, place)}
    if not isinstance(value, dict):
        return set()
    inner = {f"{place}.{key}".removeprefix("."): each for key, each in value.items()}
    return set(inner) | {key for at, each in inner.items() for key in keys_in(each, at)}


@pytest.mark.parametrize("file", CONFIGS, ids=lambda file: file.stem)
def test_every_key_of_a_shipped_study_is_in_the_reference(file):
    reference = {
        f"{section.place}.{key.name}".replace("[]", "").removeprefix(".")
        for section in declared_sections()
        for key in section.keys
    }
    data = yaml.safe_load(file.read_text())
    data.pop("points", None)  # its keys are the user's names
    data.pop("initial", None)
    if data["structure"]["kind"] in ("matrices", "identified"):
        data.pop("structure")
    assert keys_in(data) <= reference


def test_links_of_the_reference_lead_to_its_anchors():
    text = markdown()
    anchors = re.findall(r'<a id="([^"]+)">', text)
    assert len(anchors) == len(set(anchors))
    assert set(re.findall(r"\]\(#([^)]+)\)", text)) <= set(anchors)
    for key in ("supports.profile.lobes.depth_m", "structure.matrices.points", "grid.gap_m"):
        assert key in anchors


def test_tables_of_the_reference_have_seven_columns():
    for line in markdown().splitlines():
        if line.startswith("|"):
            assert len(re.findall(r"(?<!\\)\|", line)) == 8, line


def test_the_reference_states_unit_range_and_default():
    (row,) = [line for line in markdown().splitlines() if 'id="spectra.overlap"' in line]
    assert [cell.strip() for cell in row.split("|")[2:6]] == [
        "number",
        "1",
        "≥ 0, ≤ 0.95",
        "`0.65`",
    ]
    (row,) = [line for line in markdown().splitlines() if 'id="grid.gap_m"' in line]
    assert [cell.strip() for cell in row.split("|")[2:6]] == [
        "list of numbers",
        "m",
        "> 0, ≤ 10",
        "required",
    ]


@pytest.mark.parametrize("file", CONFIGS, ids=lambda file: file.stem)
def test_shipped_studies_fit_the_json_schema(file):
    jsonschema.Draft202012Validator(json_schema()).validate(yaml.safe_load(file.read_text()))


@pytest.mark.parametrize(
    ("section", "key", "value"),
    [
        ("spectra", "overlp", 0.5),
        ("spectra", "overlap", 65),
        ("grid", "seeds", 2.5),
        ("grid", "gap_m", []),
        ("excitation", "band_Hz", [5.0]),
    ],
)
def test_the_json_schema_refuses_what_the_check_refuses(section, key, value):
    data = yaml.safe_load((ROOT / "config" / "study.yaml").read_text())
    data[section][key] = value
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.Draft202012Validator(json_schema()).validate(data)


@pytest.mark.parametrize(
    ("material", "valid"),
    [
        ({"name": "zircaloy_4"}, True),
        ({"name": "zircaloy_4", "density_kg_per_m3": 6500.0}, True),
        ({"name": None, "density_kg_per_m3": 6500.0}, False),
        ({"young_modulus_Pa": 2e11, "poisson_ratio": 0.3, "density_kg_per_m3": 7800.0}, True),
        ({"young_modulus_Pa": 2e11, "poisson_ratio": 0.3}, False),
    ],
)
def test_the_json_schema_wants_a_name_or_all_numbers(material, valid):
    data = yaml.safe_load((ROOT / "config" / "study.yaml").read_text())
    data["structure"]["material"] = material
    assert jsonschema.Draft202012Validator(json_schema()).is_valid(data) == valid


def test_the_json_schema_states_units():
    schema = json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    keys = schema["$defs"]["Support"]["properties"]
    assert keys["stiffness_N_per_m"]["unit"] == "N/m"
    assert keys["hertz_N_per_m15"]["unit"] == "N/m^1.5"
    assert keys["friction"]["unit"] == "1" and "unit" not in keys["name"]
    assert schema["properties"]["points"]["unit"] == "m"
