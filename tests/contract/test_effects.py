"""The catalogue of effects: what every entry promises, checked over the registry."""

import numpy as np
import pytest

from tests.support.effect_values import term_at, with_term
from tests.support.straight_path import straight_path
from vibroimpact.config.reading import check_config
from vibroimpact.effects.effect import TESTS
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.reduction.reduced_model import build_model

CATALOGUE = {effect.reported for effect in EFFECTS.values()}
SCALES = {
    "one": 1.0,
    "gap": 2.5e-4,
    "load": 10.0,
    "displacement": 2.5e-4,
    "contact_stiffness": 4.0e6,
    "hertz": 3.0e8,
    "gap_force": 20.0,
    "mass": 0.5,
    "mass_per_length": 0.2,
    "tube_translation": 4.6e3,
    "tube_rotation": 230.0,
    "tube_damping": 1.5,
    "damping_per_length": 0.7,
    "cubic": 7.0e10,
    "quadratic": 1.8e7,
    "slowness": 50.0,
    "drag": 20.0,
}
OF_THE_MODEL = sorted(effect.id for effect in EFFECTS.values() if not effect.measured)


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
def test_catalogue_entries_are_described(effect):
    assert effect.explanation and effect.source
    assert set(effect.broken) <= set(TESTS)
    assert set(effect.aliases) <= CATALOGUE - {effect.id}
    for parameter in effect.parameters:
        assert parameter.unit and parameter.low < parameter.high and parameter.per in SCALES
        assert not parameter.log or parameter.low > 0.0


@pytest.mark.parametrize("name", OF_THE_MODEL)
def test_variant_is_valid_and_leaves_the_original_unchanged(study_config, name):
    values = study_config.model_dump(mode="json")
    before = repr(values)
    for location in EFFECTS[name].locations(values):
        varied = with_term(values, term_at(name, location, 0.6, SCALES))
        assert varied != values
        check_config(varied, name)
    assert repr(values) == before


@pytest.mark.parametrize("name", OF_THE_MODEL)
@pytest.mark.parametrize("unit", [0.0, 1.0], ids=["low", "high"])
def test_variant_is_valid_at_the_ends_of_its_range(study_config, name, unit):
    """Of a structure with much damping too."""
    values = study_config.model_dump(mode="json")
    values["damping"] |= {"first_ratios": [0.05, 0.05], "other_ratio": 0.04}
    term = term_at(name, EFFECTS[name].locations(values)[0], unit, SCALES)
    check_config(with_term(values, term), name)


@pytest.mark.parametrize("name", sorted(set(OF_THE_MODEL) - {"clearance", "one_sided_stop"}))
def test_an_effect_is_added_to_a_model_that_has_it(study_config, name):
    """As a second rod at the shaker, or a second mass. A second stop is refused as such."""
    values = study_config.model_dump(mode="json")
    term = term_at(name, EFFECTS[name].locations(values)[0], 0.6, SCALES)
    check_config(with_term(with_term(values, term), term), name)


@pytest.mark.parametrize(
    "name", [name for name in OF_THE_MODEL if EFFECTS[name].neutral() is not None]
)
def test_neutral_is_the_bare_model_bit_for_bit(study_config, name):
    effect = EFFECTS[name]
    values = study_config.model_dump(mode="json")
    neutral = build_model(
        check_config(effect.apply(values, effect.neutral(), effect.locations(values)[0]), name)
    )
    bare = build_model(study_config)
    assert np.array_equal(neutral.omega, bare.omega)
    assert np.array_equal(neutral.damping, bare.damping)
    for column in (
        "contact_shapes",
        "contact_stiffness",
        "gap_factor",
        "centre_offset",
        "drive_shapes",
        "constant_force",
    ):
        assert np.array_equal(getattr(neutral, column), getattr(bare, column)), column
    laws = neutral.contact_laws
    assert (
        not laws.damping.any()
        and not laws.hunt_crossley.any()
        and not laws.hertz.any()
        and not laws.friction.any()
        and not laws.lobe_depth.any()
    )
    assert not any(
        np.any(getattr(neutral.local_laws, column))
        for column in (
            "stiffness",
            "quadratic",
            "cubic",
            "damping",
            "drag",
            "slip_limit",
            "saturation_limit",
        )
    )


@pytest.mark.parametrize("along", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.6, 0.0, 0.8)])
def test_drag_brakes_a_tube_across_it_wherever_it_points(along):
    tube = {"kind": "tube", "outer_diameter_m": 0.02, "wall_thickness_m": 0.001}
    structure = straight_path(1.0, list(along), tube, (2.0e11, 0.3, 8000.0))
    values = {"structure": structure, "points": {}, "elements": []}
    changed = EFFECTS["quadratic_drag"].apply(values, {"coefficient": 20.0}, "tube")
    directions = np.array([element["direction"] for element in changed["elements"]])
    assert len(directions) == 16
    np.testing.assert_allclose(directions @ along, 0.0, atol=1e-12)
    assert np.linalg.matrix_rank(directions) == 2
