"""The catalogue page: every effect once, with its parameters, its law and its source."""

import re

import pytest

from docs.effects_page import markdown
from vibroimpact.effects.effect import SCALES
from vibroimpact.effects.registry import EFFECTS

SECTIONS = re.split(r"^### `(\w+)`\n", markdown(), flags=re.M)[1:]
PAGE = dict(zip(SECTIONS[::2], SECTIONS[1::2], strict=True))


def test_every_effect_has_one_section():
    assert sorted(SECTIONS[::2]) == sorted(EFFECTS)


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
def test_a_section_holds_what_the_effect_states(effect):
    section = PAGE[effect.id]
    rows = re.findall(r"^\| `(\w+)` \| (.+?) \| (.+?) \| (.+?) \| (.+?) \|$", section, flags=re.M)
    assert [name for name, *_ in rows] == [parameter.name for parameter in effect.parameters]
    assert all(meaning.strip() for _, meaning, *_ in rows)
    assert f"- Law: {effect.law}." in section and f"- Source: {effect.source}." in section
    assert all(f"{test} (" in section for test in effect.broken)
    assert all(f"`{name}`" in section for name in effect.aliases)


def test_a_row_states_unit_bounds_and_neutral_value():
    assert "| `mass` | the point mass | kg | 0.002 to 2 times the modal mass" in PAGE["added_mass"]
    assert "| - | 0.25 to 4 | 1 |" in PAGE["sensor_gain"]
    assert ", as a multiple of `mass` | no such value |" in PAGE["plate_flexibility"]


def test_every_bound_has_a_size():
    used = {parameter.per for effect in EFFECTS.values() for parameter in effect.parameters}
    assert used <= set(SCALES)


def test_the_catalogue_is_in_alphabetical_order():
    assert list(EFFECTS) == sorted(EFFECTS)  # ranks of equal score depend on it
