"""The place of a mass on a tube where the named points about it explain less than one far away."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.effects import places
from vibroimpact.linear_stage import effect_places as linear_places
from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.linear_stage.effect_fit import LinearResult

SIZES = {}


def result(candidate, gain):
    """A fit of one candidate that explains so much."""
    return LinearResult(candidate, np.array([0.8]), gain, np.array([[0.7, 0.9]]))


@pytest.fixture
def named(study_config):
    """Values of the study's tube, a mass at a named point, and where the named points are."""
    values = study_config.model_dump(mode="json")
    mass = candidate_named(f"added_mass@{next(iter(values['points']))}")
    locations = mass.effect.locations(values)
    arcs = places.arc_lengths(values, locations)
    return values, mass, dict(zip(locations, arcs, strict=True))


def test_a_place_two_spans_from_the_best_point_is_found(named, monkeypatch):
    values, mass, arcs = named
    known = sorted(arcs.values())
    widest = int(np.argmax(np.diff(known)))
    at = known[widest] + 0.45 * (known[widest + 1] - known[widest])
    apart = known[widest + 1] - known[widest]
    far = max(known, key=lambda arc: abs(arc - at))

    def gain(arc):
        peak = 1000.0 * np.exp(-0.5 * ((arc - at) / (0.45 * apart)) ** 2)
        return max(peak, 700.0 * np.exp(-0.5 * ((arc - far) / 0.01) ** 2))

    def fitted(_bench, _changes, candidate, _unit, _sizes):
        return result(candidate, gain(places.arc_length_m(candidate.location)))

    monkeypatch.setattr(linear_places, "fitted", fitted)
    monkeypatch.setattr(linear_places, "table_of", lambda *_: "table")
    found = [result(replace(mass, location=location), gain(arc)) for location, arc in arcs.items()]
    assert max(found, key=lambda row: row.gain).candidate.location == next(
        location for location, arc in arcs.items() if arc == far
    )
    tables = {}
    placed = linear_places.placed(SimpleNamespace(values=values), None, found, SIZES, tables)
    assert places.arc_length_m(placed.candidate.location) == pytest.approx(at, abs=2.0e-3)
    assert tables == {placed.candidate.name: "table"}


def test_a_mass_at_the_free_end_stays_there(named, monkeypatch):
    """There is nowhere to look beyond it."""
    values, mass, arcs = named
    end = places.length_m(values)
    tip = places.between(end)
    values = places.with_place(values, tip)
    known = arcs | {tip: places.arc_lengths(values, [tip])[0]}

    def gain(arc):
        return 1000.0 * arc / end

    def fitted(_bench, _changes, candidate, _unit, _sizes):
        return result(candidate, gain(places.arc_length_m(candidate.location)))

    monkeypatch.setattr(linear_places, "fitted", fitted)
    found = [result(replace(mass, location=place), gain(arc)) for place, arc in known.items()]
    assert (
        linear_places.placed(SimpleNamespace(values=values), None, found, SIZES, tables={}) is None
    )
