"""The configuration: what is accepted, every refusal with place, value and remedy, and that every
key is used.
"""

import ast
import copy
import datetime
import math
import re
from pathlib import Path

import pytest
import yaml

from vibroimpact.config.reading import Config, ConfigError, check_config, load_config
from vibroimpact.config.reserved_names import TARGETS
from vibroimpact.config.stage_keys import STAGE_KEYS, select, stage_params
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact_workflow.asked_numbers import asked_number

ROOT = Path(__file__).parents[2]
STUDY = ROOT / "config" / "study.yaml"
OTHER_KINDS = {
    "structure": {
        "kind": "path",
        "theory": "euler_bernoulli",
        "section": {"outer_diameter_m": 0.02, "wall_thickness_m": 0.001, "shear_coefficient": 0.5},
        "material": {"young_modulus_Pa": 2.1e11, "poisson_ratio": 0.3, "density_kg_per_m3": 7800.0},
        "fluid": [
            {"kind": "inside", "name": "water", "temperature_C": 280.0, "to_m": [0.5, 0.0, 0.0]},
            {
                "kind": "outside",
                "density_kg_per_m3": 740.0,
                "viscosity_Pa_s": 9.0e-5,
                "confinement": {"kind": "bundle", "pitch_m": 0.03, "pattern": "square"},
            },
        ],
        "start_m": [0.0, 0.0, 0.0],
        "start_direction": [1.0, 0.0, 0.0],
        "segments": [
            {"kind": "straight", "length_m": 1.0},
            {"kind": "bend", "radius_m": 0.2, "angle_deg": 90.0, "toward": [0.0, 0.0, 1.0]},
            {"kind": "straight", "length_m": 0.5},
        ],
        "mesh": {"elements_per_span": 5, "elements_per_bend": 6},
        "start": {"kind": "springs", "translation_N_per_m": 1e8, "rotation_N_m_per_rad": 1e5},
        "end": {"kind": "free"},
    },
    "damping": {"kind": "rayleigh", "mass_coefficient_per_s": 0.5, "stiffness_coefficient_s": 1e-5},
    "supports": [
        {
            "name": "middle",
            "at_m": [0.5, 0.0, 0.0],
            "height_m": 0.02,
            "points": 3,
            "stiffness_N_per_m": [1e5, 2e5, 1e5],
            "gap_factor": [1.0, 1.1, 1.0],
            "centre_offset_m": [[0.0, 1e-5], [0.0, 2e-5], [0.0, 0.0]],
        }
    ],
    "points": {"drive": [0.3, 0.0, 0.0], "tip": [1.2, 0.0, 0.7]},
    "excitation": {
        "kind": "measured",
        "point": "drive",
        "direction": [0.0, 1.0, 0.0],
        "file": str(STUDY),
        "variable": "force",
        "sampling_frequency_Hz": 2048.0,
    },
    "record": {"sensors": {"points": ["tip"], "directions": ["y"]}},
    "identification": {
        "response_point": "tip",
        "lscf": {"references": ["tip"]},
        "broadband": {"point": "tip"},
    },
}


@pytest.fixture
def study():
    """The mapping in config/study.yaml, free to be changed."""
    return yaml.safe_load(STUDY.read_text())


@pytest.fixture
def other_kinds(study):
    """A valid mapping with the kinds of section that study.yaml does not use."""
    return {**study, **copy.deepcopy(OTHER_KINDS)}


def problems(mapping):
    """The sentences that a mapping is refused with."""
    with pytest.raises(ConfigError) as refusal:
        check_config(mapping, "config/mine.yaml")
    return refusal.value.problems


def put(mapping, place, value):
    """Set a value at a dotted place; a number is an index into a list."""
    *parts, last = [int(part) if part.isdigit() else part for part in place.split(".")]
    for part in parts:
        mapping = mapping[part]
    mapping[last] = value


def leaves(value, place=""):
    """Yield (dotted place, value) of everything in a mapping that is no mapping and no list."""
    if isinstance(value, (dict, list)):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(inner, f"{place}.{key}" if place else str(key))
    else:
        yield place, value


@pytest.mark.parametrize(
    "file", sorted((ROOT / "config").glob("*.yaml")), ids=lambda file: file.name
)
def test_the_configurations_that_are_shipped_are_valid(file):
    load_config(file)


def test_default_study_is_the_published_one():
    config = load_config(STUDY)
    diameter = config.structure.section.outer_diameter_m
    assert diameter == 0.02222
    assert [round(gap / diameter * 100, 3) for gap in config.grid.gap_m] == [1.3, 0.9, 0.23]
    assert (
        config.grid.load_rms_N.first,
        config.grid.load_rms_N.last,
        config.grid.load_rms_N.count,
    ) == (0.05, 20.0, 24)
    assert (config.grid.seeds, config.record.duration_s, config.spectra.overlap) == (4, 49.0, 0.65)
    assert sum(support.stiffness_N_per_m for support in config.supports) == 8e6


def test_the_default_study_names_every_key():
    config = load_config(STUDY)
    assert config.model_dump(exclude_unset=True) == config.model_dump()


def test_other_kinds_of_section_are_accepted(other_kinds):
    config = check_config(other_kinds, "mine")
    assert config.supports[0].stiffness_N_per_m == (1e5, 2e5, 1e5)
    assert config.supports[0].centre_offset_m[1] == (0.0, 2e-5)
    assert config.structure.segments[1].angle_deg == 90.0


def test_a_number_without_a_point_is_a_number(study):
    # YAML reads 1e8 as a text: it must not be refused, and must not stay a text.
    put(
        study,
        "structure.root",
        {"kind": "springs", "translation_N_per_m": "1e8", "rotation_N_m_per_rad": 1e5},
    )
    assert check_config(study, "mine").structure.root.translation_N_per_m == 1e8


def test_overrides_replace_top_level_keys():
    assert load_config(STUDY, {"seed": 7}).seed == 7


REFUSALS = [
    # place, value, what the sentence must hold: place, value, rule, remedy
    ("sead", 3, ["unknown key 'sead'", "did you mean 'seed'?"]),
    (
        "supports.1.gapfactor",
        2.0,
        ["unknown key 'gapfactor' in supports[1]", "did you mean 'gap_factor'?"],
    ),
    (
        "grid.gap_m.2",
        -1.3e-4,
        ["grid.gap_m[2] = -0.00013 must be > 0", "radial clearance in metres"],
    ),
    ("structure.section.outer_diameter_m", 22.22, ["outer_diameter_m = 22.22", "in metres?"]),
    (
        "structure.section.wall_thickness_m",
        0.0127,
        ["wall_thickness_m = 0.0127", "half the outer diameter"],
    ),
    ("structure.material.young_modulus_Pa", 202, ["young_modulus_Pa = 202", "in Pa?"]),
    ("structure.kind", "utube", ["structure.kind = 'utube' must be one of", "u_tube"]),
    ("damping.other_ratio", 1.5, ["damping.other_ratio = 1.5", "not per cent"]),
    (
        "supports.0.stiffness_N_per_m",
        [1e6, 1e6],
        ["supports[0].stiffness_N_per_m", "2 values for 5 contact points"],
    ),
    (
        "supports.0.at_m",
        [-0.36, 0.0, 0.35],
        ["supports[0].at_m", "0.0600 m off the tube", "[-0.3, 0.0, 0.35]"],
    ),
    (
        "supports.0.height_m",
        0.8,
        ["supports[0].height_m = 0.8", "beyond the segment", "at most 0.7 m"],
    ),
    ("supports.1.name", "left", ["supports = 'left' names 2 supports"]),
    (
        "supports.1.centre_offset_m",
        [0.0, 0.3, 0.0],
        ["supports[1].centre_offset_m", "3 values", "transverse"],
    ),
    ("points.apex", [0.0, 0.02, 1.0], ["points.apex", "0.0200 m off the tube"]),
    (
        "identification.groups",
        [["left"], ["rigt"]],
        ["identification.groups[1][0] = 'rigt' is no support", "did you mean 'right'?"],
    ),
    (
        "identification.groups",
        [["left", "right"], ["left"]],
        ["identification.groups[1][0] = 'left' is in group 0 already"],
    ),
    ("excitation.point", "shakr", ["excitation.point = 'shakr'", "did you mean 'shaker'?"]),
    ("excitation.direction", [0, 0, 0], ["excitation.direction", "not a direction"]),
    ("excitation.band_Hz", [200.0, 5.0], ["excitation.band_Hz = [200.0, 5.0]", "ascending"]),
    (
        "excitation.band_Hz",
        [5.0, 3000.0],
        ["steps_per_second = 20480", "20 steps per period", "3000 Hz", "at least 60000"],
    ),
    (
        "basis.free_modes_to_Hz",
        9500.0,
        ["steps_per_second = 20480", "omega x step = 2.91", "at least 21318", "fewer free modes"],
    ),
    (
        "integration.scheme",
        "newmark",
        ["steps_per_second = 20480", "omega x step = 2.3", "at most 1", "at least 47124"],
    ),
    (
        "integration.steps_per_second",
        50000,
        ["steps_per_second = 50000", "5 times a whole multiple", "51200 is near"],
    ),
    (
        "record.sampling_frequency_Hz",
        4096,
        ["steps_per_second = 20480", "5 times a whole multiple", "by 2 or more", "40960 is near"],
    ),
    ("integration.steps_per_second", True, ["steps_per_second = True must be a number"]),
    ("integration.start_up_s", 0.0001, ["integration.start_up_s", "whole number of samples"]),
    ("record.sensors.directions", ["x"], ["record.sensors.directions", "lacks 'y'"]),
    (
        "record.shape_line.direction",
        "z",
        ["record.shape_line.direction = 'z'", "not a direction of the sensors"],
    ),
    ("record.duration_s", 5.0, ["spectra.segment_s = 10.0", "longer than the record, 5 s"]),
    (
        "identification.response_point",
        "shaker",
        ["identification.response_point = 'shaker'", "not recorded"],
    ),
    (
        "identification.lscf.band_Hz",
        [8.0, 2000.0],
        ["identification.lscf.band_Hz", "reaches above 800 Hz"],
    ),
    (
        "identification.broadband.band_Hz",
        [2.0, 99.0],
        ["identification.broadband.band_Hz", "beyond the excited band"],
    ),
    ("grid.load_rms_N", [1.0, 2.0, 1.0], ["grid.load_rms_N = 1.0", "2 times"]),
    (
        "overlay.campaign",
        "no/such.nc",
        ["overlay.campaign = 'no/such.nc' is not a file", "or null"],
    ),
    ("overlay.seed", 3, ["overlay.seed = 3 is a seed of the study", "larger"]),
    ("study", "a/b", ["study = 'a/b'", "folder name"]),
]


@pytest.mark.parametrize(
    ("place", "value", "parts"), REFUSALS, ids=[f"{place}={value}" for place, value, _ in REFUSALS]
)
def test_a_mistake_is_named_with_its_place_and_remedy(study, place, value, parts):
    put(study, place, value)
    found = problems(study)
    assert all(line.startswith("config/mine.yaml: ") for line in found)
    assert any(all(part in line for part in parts) for line in found), "\n".join(found)


SECTIONS = {
    "round": {"kind": "round", "diameter_m": 0.02},
    "rectangle": {"kind": "rectangle", "sides_m": [0.01, 0.03], "first_axis": [0.0, 1.0, 1.0]},
    "general": {
        "kind": "general",
        "area_m2": 3.0e-4,
        "second_moments_m4": [2.5e-9, 2.2e-8],
        "torsion_constant_m4": 7.9e-9,
        "shear_coefficients": [0.8, 0.8],
        "outer_fibres_m": [0.005, 0.015],
        "enclosed_area_m2": 4.0e-4,
    },
}
WATER = {"kind": "outside", "name": "water"}


@pytest.mark.parametrize("kind", SECTIONS)
def test_sections_of_every_kind_are_accepted(other_kinds, kind):
    put(other_kinds, "structure.section", SECTIONS[kind])
    put(other_kinds, "structure.fluid", [])
    section = check_config(other_kinds, "mine").structure.section
    assert section.kind == kind


STRUCTURE_REFUSALS = [
    # changes of the structure, what the sentence must hold
    (
        {"section": SECTIONS["rectangle"] | {"first_axis": [2.0, 0.0, 0.0]}},
        ["section.first_axis", "is along the tube at its start, [1.0, 0.0, 0.0]", "across it"],
    ),
    (
        {"section": SECTIONS["general"] | {"enclosed_area_m2": 1.0e-4}},
        ["enclosed_area_m2 = 0.0001 is below the area of the material, 0.0003 m2"],
    ),
    (
        {"section": SECTIONS["rectangle"], "fluid": [WATER]},
        ["fluid[0].confinement.kind = 'unconfined' is for round sections", "coefficient"],
    ),
    (
        {"section": SECTIONS["round"], "fluid": [{"kind": "inside", "name": "water"}]},
        ["fluid[0].kind = 'inside' needs a hollow section", "kind round is solid"],
    ),
    (
        {"fluid": [WATER | {"confinement": {"kind": "bundle", "pitch_m": 0.02}}]},
        ["confinement.pitch_m = 0.02 must be above the diameter of the tube, 0.02 m"],
    ),
    (
        {"fluid": [WATER | {"temperature_C": 400.0}]},
        ["fluid[0].temperature_C = 400", "water is known from 0.01 to 350 °C"],
    ),
    (
        {"fluid": [{"kind": "outside", "density_kg_per_m3": 1000.0}]},
        ["fluid[0].viscosity_Pa_s is missing: give it, or a name"],
    ),
    (
        {"fluid": [WATER | {"to_m": [0.5, 0.0, 0.0]}, WATER | {"from_m": [0.4, 0.0, 0.0]}]},
        ["fluid[1] = 'outside' overlaps another fluid outside"],
    ),
    ({"fluid": [WATER | {"to_m": [0.0, 0.0, 0.0]}]}, ["fluid[0].to_m", "start of the fluid"]),
    (
        {
            "fluid": [
                WATER
                | {
                    "viscosity_Pa_s": 1e-3,
                    "confinement": {"kind": "coefficient", "added_mass_coefficient": 2.0},
                }
            ]
        },
        ["viscosity_Pa_s = 0.001 has no effect with an added mass coefficient"],
    ),
    (
        {"material": {"name": "inconel_600", "temperature_C": 700.0}},
        ["temperature_C = 700", "inconel_600 is known from 20 to 500 °C", "young_modulus_Pa"],
    ),
    (
        {"material": {"young_modulus_Pa": 2.0e11, "poisson_ratio": 0.3}},
        ["material.density_kg_per_m3 is missing: give it, or a name"],
    ),
]


@pytest.mark.parametrize(
    ("changes", "parts"), STRUCTURE_REFUSALS, ids=[parts[0] for _, parts in STRUCTURE_REFUSALS]
)
def test_mistakes_of_section_material_and_fluid(other_kinds, changes, parts):
    put(other_kinds, "structure.fluid", [])
    for key, value in changes.items():
        put(other_kinds, f"structure.{key}", value)
    found = problems(other_kinds)
    assert any(all(part in line for part in parts) for line in found), "\n".join(found)


def test_a_named_material_is_filled_in_and_can_be_overridden(study):
    put(study, "structure.material", {"name": "inconel_600", "density_kg_per_m3": 8330.0})
    material = check_config(study, "mine").structure.material
    assert material.temperature_C == 20.0
    assert material.young_modulus_Pa == pytest.approx(213.4e9, rel=1e-3)
    assert (material.poisson_ratio, material.density_kg_per_m3) == (0.3, 8330.0)
    # The configuration as it runs holds the numbers, and is a valid configuration again.
    put(study, "structure.material", material.model_dump())
    assert check_config(study, "mine").structure.material == material


def test_a_missing_key_is_described_by_itself(study):
    del study["structure"]["leg_length_m"], study["grid"], study["excitation"]["kind"]
    told = problems(study)
    assert any("leg_length_m is missing: length of each leg" in each for each in told)
    assert any("in m, such as 0.7" in each for each in told)
    assert any("grid is missing" in each and "load_rms_N, gap_m, seeds" in each for each in told)
    assert any("excitation.kind is missing: give one of band_limited" in each for each in told)


HIDDEN = {  # a misspelled word -> mistakes that can be seen only where it is put right
    ("structure.kind", "u_tub"): ("structure.legs", 1.0, "unknown key 'legs' in structure"),
    ("excitation.kind", "band_limted"): ("excitation.point", "shakr", "did you mean 'shaker'?"),
    ("supports.0.profile.kind", "circulr"): ("excitation.point", "shakr", "'shaker'?"),
    ("integration.scheme", "exakt"): ("integration.steps_per_second", 100, "at least 4000"),
    ("structure.theory", "timoshenk"): ("supports.0.at_m", [0.0, 0.0, 5.0], "off the tube"),
}


@pytest.mark.parametrize(("word", "mistake"), HIDDEN.items(), ids=lambda each: str(each[0]))
def test_a_misspelled_word_hides_no_other_mistake(study, word, mistake):
    put(study, *word)
    place, value, sentence = mistake
    put(study, place, value)
    told = problems(study)
    assert any(f"{word[0].replace('.0', '[0]')} = '{word[1]}' must be" in each for each in told)
    assert any(sentence in each for each in told)


def test_a_misspelled_word_alone_is_one_problem(study):
    put(study, "structure.kind", "u_tub")
    assert len(problems(study)) == 1


@pytest.mark.parametrize(
    ("place", "value", "told"),
    [
        ("grid.gap_m", [math.nan], "grid.gap_m[0] = nan must be a finite number"),
        ("grid.gap_m", [], "grid.gap_m = [] must not be empty"),
        (
            "seed",
            1e19,
            "seed = 1e+19 is too large a whole number: give at most 9223372036854775807",
        ),
        ("seed", 10**19, "seed = 10000000000000000000 must be <= 9.22337e+18: any whole number"),
    ],
)
def test_a_wrong_value_is_one_problem_in_plain_words(study, place, value, told):
    put(study, place, value)
    assert problems(study) == [f"config/mine.yaml: {told}"]


def test_a_table_of_one_point_is_told(study):
    table = {"kind": "table", "frequency_Hz": [5.0], "psd_N2_per_m2_Hz": [0.01]}
    study["excitation"] = {
        "kind": "turbulence", "direction": [0.0, 1.0, 0.0], "correlation_length_m": 0.1,
        "band_Hz": [5.0, 200.0], "spectrum": table,
    }  # fmt: skip
    told = problems(study)
    assert any("frequency_Hz = [5.0] has too few values: give 2 or more" in each for each in told)


def test_the_point_of_a_mass_is_told_with_its_place(study):
    study["masses"] = [{"name": "a", "point": "apx", "mass_kg": 0.1}]
    assert problems(study) == [
        "config/mine.yaml: masses[0].point = 'apx' is not one of the named points: did you mean"
        " 'apex'?"
    ]


def test_bend_along_its_own_tangent_is_refused(other_kinds):
    put(other_kinds, "structure.segments.1.toward", [2.0, 0.0, 0.0])
    assert any(
        "structure.segments[1].toward" in line and "parallel to the tube" in line
        for line in problems(other_kinds)
    )
    put(other_kinds, "structure.start_direction", [0, 0, 0])
    assert any(
        "structure.start_direction = [0, 0, 0] is not a direction" in line
        for line in problems(other_kinds)
    )


def test_a_force_file_that_is_not_there_is_named(other_kinds):
    put(other_kinds, "excitation.file", "no/such/force.csv")
    assert any(
        "excitation.file = 'no/such/force.csv' is not a file" in line
        for line in problems(other_kinds)
    )


def test_all_problems_are_reported_together(study):
    # Of the schema and between keys, in different sections.
    put(study, "spectra.overlp", 0.5)
    put(study, "grid.gap_m.2", -1.3e-4)
    put(study, "points.apex", [0.0, 0.0, 1.1])
    put(study, "supports.0.height_m", 0.9)
    put(study, "integration.steps_per_second", 10240)
    put(study, "integration.stepz", 3)
    found = "\n".join(problems(study))
    for part in ("'overlp'", "gap_m[2]", "points.apex", "supports[0].height_m", "omega x step"):
        assert part in found


def test_unreadable_file_is_reported_in_a_sentence(tmp_path):
    with pytest.raises(ConfigError, match="nowhere.yaml: cannot be read .*give the path"):
        load_config(tmp_path / "nowhere.yaml")
    broken = tmp_path / "broken.yaml"
    empty = tmp_path / "empty.yaml"
    twice = tmp_path / "twice.yaml"
    broken.write_text("a: [1\nb: 2")
    empty.write_text("")
    twice.write_text(STUDY.read_text() + "\nseed: 3\n")
    last = len(STUDY.read_text().splitlines())
    with pytest.raises(ConfigError, match="broken.yaml: line 2, column 2: the list"):
        load_config(broken)
    with pytest.raises(ConfigError, match="empty.yaml: holds no keys"):
        load_config(empty)
    with pytest.raises(ConfigError, match=rf"line {last + 2}, column 1: key 'seed' is given twice"):
        load_config(twice)


def test_a_config_can_not_be_changed():
    config = load_config(STUDY)
    with pytest.raises(ValueError, match="frozen"):
        config.seed = 3


LOBES = {"kind": "lobes", "count": 3}
STOPS = {"kind": "planes", "normals_deg": [0, 180]}


@pytest.mark.parametrize(
    ("place", "value", "told"),
    [
        ("supports.0.gap_factor", 1e6, "supports[0].gap_factor = 1000000.0 makes the gap"),
        ("supports.0.profile", LOBES | {"depth_m": 1e20}, "supports[0].profile.depth_m = 1e+20"),
        ("supports.0.centre_offset_m", [0.005, 0.0], "times the clearance"),
        ("supports.0.profile", {"kind": "planes", "normals_deg": [10, 370]}, "there already"),
        ("supports.0.profile", STOPS | {"extra_gap_m": [0.0]}, "has 1 values for 2 stops"),
        ("supports.0.profile", STOPS | {"extra_gap_m": [0.0, 0.5]}, "profile.extra_gap_m = 0.5"),
    ],
)
def test_a_support_out_of_reach_or_twice_is_refused(study, place, value, told):
    study["grid"]["gap_m"] = [1e-4]
    put(study, place, value)
    assert any(told in each for each in problems(study))


def test_a_place_that_a_tube_passes_twice_is_refused(other_kinds):
    loop = {"kind": "bend", "radius_m": 0.2, "angle_deg": 359.99, "toward": [0.0, 0.0, 1.0]}
    other_kinds["structure"]["segments"].insert(1, loop)
    other_kinds["points"]["drive"] = [1.0, 0.0, 0.0]
    told = [each for each in problems(other_kinds) if "on the tube twice" in each]
    assert told[0].startswith("config/mine.yaml: points.drive = [1.0, 0.0, 0.0]")


def test_a_tube_of_other_units_is_blamed_on_its_length(study, other_kinds):
    put(study, "structure.leg_length_m", 800.0)
    assert any("structure.leg_length_m = '1600.94 m' makes the tube" in p for p in problems(study))
    put(other_kinds, "structure.segments.0.length_m", 800.0)
    assert any("structure.segments = '800.814 m'" in each for each in problems(other_kinds))


def test_a_mass_named_ground_and_a_stop_twice_are_refused():
    chain = yaml.safe_load((ROOT / "config/examples/mass_between_stops.yaml").read_text())
    chain["supports"].append(chain["supports"][0] | {"name": "again"})
    chain["structure"]["masses"].append({"name": "ground", "mass_kg": 1.0})
    told = "\n".join(problems(chain))
    assert "supports[1] = 'again' is 'stops' again" in told
    assert "structure.masses[1].name = 'ground' is the name of the earth in springs" in told


FLOW = {  # stages read parts of it
    "acting_m_per_s": 1.0,
    "density_kg_per_m3": 700.0,
    "direction": [0.0, 1.0, 0.0],
    "both_directions": False,
    "stretches": [],
    "coupling": None,
}


@pytest.mark.parametrize("kinds", ["study", "other_kinds"])
def test_every_key_changes_the_parameters_of_some_stage(kinds, request):
    values = check_config(request.getfixturevalue(kinds), "mine").model_dump(mode="json")
    # The validation reads the whole study and would count for every key.
    stages = {stage: keys for stage, keys in STAGE_KEYS.items() if stage != "validation"}
    before = {stage: select(copy.deepcopy(values), keys) for stage, keys in stages.items()}
    unused = []
    for place, _ in leaves(values):
        changed = copy.deepcopy(values)
        put(changed, place, FLOW if place == "flow" else "another value")
        if all(select(changed, keys) == before[stage] for stage, keys in stages.items()):
            unused.append(place)
    assert unused == []


@pytest.mark.parametrize("kinds", ["study", "other_kinds"])
def test_every_key_is_read_somewhere(kinds, request):
    """A key that a stage declares and no code reads would be a promise without effect."""
    library = [
        file
        for file in (ROOT / "src").rglob("*.py")
        if "config" not in file.relative_to(ROOT / "src").parts
    ]
    nodes = [node for file in library for node in ast.walk(ast.parse(file.read_text()))]
    read = {node.attr for node in nodes if isinstance(node, ast.Attribute)}
    read |= {
        node.value
        for node in nodes
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    rules = "".join(file.read_text() for file in (ROOT / "workflow" / "rules").glob("*.smk"))
    values = check_config(request.getfixturevalue(kinds), "mine").model_dump(mode="json")
    values["points"] = {}
    names = {part for place, _ in leaves(values) for part in place.split(".") if not part.isdigit()}
    assert {name for name in names if name not in read and f".{name}" not in rules} == set()


def test_stage_sees_only_its_declared_keys():
    settings = StageSettings(stage_params(load_config(STUDY), "basis"))
    config = load_config(STUDY)
    assert settings.structure.section.outer_diameter_m == config.structure.section.outer_diameter_m
    assert settings.supports[1].centre_offset_m == config.supports[1].centre_offset_m
    assert dict(settings.points.items())["apex"] == config.points["apex"]
    assert settings.record.sensors.points == config.record.sensors.points
    with pytest.raises(
        AttributeError,
        match="'record.duration_s' was not given to this stage: declare it in STAGE_KEYS",
    ):
        _ = settings.record.duration_s
    with pytest.raises(AttributeError, match="can not be changed"):
        settings.study = "other"


def test_every_declared_key_exists():
    assert {key.split(".")[0] for keys in STAGE_KEYS.values() for key in keys} <= set(
        Config.model_fields
    )


FOLDERS_OF_TARGETS = re.compile(r"\bresults/([A-Za-z0-9_-]+)")


def test_a_study_can_not_have_the_folder_of_a_target(study):
    # Every folder in results/ that a rule names; {study}, {drawn} and the like are wildcards.
    rules = [
        file for folder in ("workflow", "evidence") for file in ROOT.glob(f"{folder}/rules/*.smk")
    ]
    found = {name for file in rules for name in FOLDERS_OF_TARGETS.findall(file.read_text())}
    assert set(TARGETS) == found == {"validation"}
    for name in (*found, "Validation", "acceptance_7", "development_12"):
        (line,) = problems({**study, "study": name})
        assert line.startswith(
            f"config/mine.yaml: study = '{name}' is the folder of another target"
        )
    check_config({**study, "study": "acceptance"}, "mine")


@pytest.mark.parametrize("name", ["", "a/b", "../x", ".", "a b", "é", "-a", "a\n", "a" * 101, 7])
def test_a_study_name_is_a_short_name_of_a_folder(study, name):
    (line,) = problems({**study, "study": name})
    assert "study = " in line


@pytest.mark.parametrize(
    ("place", "value", "part"),
    [
        ("supports.0.stiffness_N_per_m", 1e30, "is beyond any quantity in SI units"),
        ("supports.0.stiffness_N_per_m", "nan", "must be a finite number"),
        ("supports.0.damping_N_s_per_m", float("inf"), "must be a finite number"),
        ("points.apex", [0, 0, 10**400], "points.apex"),
        ("record.duration_s", 1e-12, "is 2.05e-09 samples"),
        ("grid.load_rms_N", {"first": 1.0, "last": 1.0001, "count": 1000}, "equal to 6 digits"),
        ("grid.seeds", 10000, "cases, at most 1000000"),
        ("seed", datetime.date(2012, 1, 1), "seed = 2012-01-01 must be a whole number"),
        ("overlay.campaign", 5000 * "a", "is not a file"),
    ],
)
def test_values_that_no_study_has_are_refused(study, place, value, part):
    put(study, "grid.load_rms_N.count", 40)
    put(study, place, value)
    assert part in "\n".join(problems(study))


@pytest.mark.parametrize("kind", ["supports", "elements", "masses"])
def test_names_of_parts_are_given_once(study, kind):
    entry = {"name": "one", "point": "apex"}
    entries = {
        "supports": study["supports"][:1],
        "elements": [{**entry, "direction": [1.0, 0.0, 0.0], "stiffness_N_per_m": 1.0}],
        "masses": [{**entry, "mass_kg": 0.1}],
    }[kind]
    study[kind] = entries
    check_config(study, "mine")
    study[kind] = [*entries, *entries]
    assert any(f"names 2 {kind}: give each a name" in line for line in problems(study))


def test_a_key_that_is_no_text_is_named(study):
    study["record"][7] = 1
    assert "config/mine.yaml: the key 7 of record must be a text" in problems(study)


def test_numbers_beside_the_study_are_positive_or_whole():
    assert asked_number("seconds", "49", "49", whole=True) == 49
    assert asked_number("draw", "0", "1", whole=True) == 0
    assert asked_number("compared_s", "0.5", "49") == 0.5
    for text in ("abc", "", "nan", "inf", "-1", "0.5", "1e30", "1" * 400):
        with pytest.raises(ValueError, match=r"draw = '.*': give a whole number, as in --config"):
            asked_number("draw", text, "1", whole=True)
    for text in ("abc", "nan", "inf", "-1", "0"):
        with pytest.raises(ValueError, match=r"compared_s = '.*': give a positive number"):
            asked_number("compared_s", text, "49")
