"""Channels against a linear model: one beam plays the measurement, another, 0.5 % stiffer and
damped otherwise, the model.
"""

from itertools import combinations

import numpy as np
import pytest

from vibroimpact.campaign.checks.model_comparison import compare_with_model
from vibroimpact.campaign.signals import Transfer

PLACES = np.array([0.13, 0.3, 0.42, 0.61, 0.8])
NAMES, KINDS = [f"y{index}" for index in range(5)], ["acceleration"] * 5
LINES = np.arange(5.0, 200.0, 0.125)


def beam(stretch=1.0, damping=0.01):
    """(place, line) response per force of six modes whose shapes are sines, force at 0.35 of the
    span.
    """
    orders, omega = np.arange(1, 7), 2.0 * np.pi * LINES[:, None]
    poles = 2.0 * np.pi * stretch * np.array([8.0, 21.0, 47.0, 90.0, 130.0, 181.0])
    modal = 1.0 / (poles**2 - omega**2 + 2j * damping * poles * omega)
    return (
        -(omega**2)
        * (modal @ (np.sin(np.pi * np.outer(PLACES, orders)) * np.sin(0.35 * np.pi * orders)).T)
    ).T


def spectra(h1):
    """A Transfer of measured responses per force, fully coherent."""
    return Transfer(LINES, h1, np.full(h1.shape, 0.98), np.ones(len(h1)), np.ones(len(h1)), 12, 5.0)


def test_nearly_correct_model_flags_no_channel():
    assert (
        compare_with_model(
            spectra(beam(1.005, 0.02) * np.array([1.02, 0.98, 1.0, 1.01, 0.99])[:, None]),
            beam(),
            NAMES,
            KINDS,
        )
        == []
    )


@pytest.mark.parametrize("first, second", [*combinations(range(5), 2)])
def test_exchanged_channels_are_detected(first, second):
    measured = beam(1.005, 0.02)
    measured[[first, second]] = measured[[second, first]]
    rows = compare_with_model(spectra(measured), beam(), NAMES, KINDS, "low")
    assert [(row["check"], row["channel"], row["record"]) for row in rows] == [
        ("swapped channels", NAMES[place], "low") for place in (first, second)
    ]
    assert f"at {NAMES[second]}" in rows[0]["message"]


def test_channels_of_other_kinds_are_not_exchanged():
    measured = beam()[[1, 0, 2, 3, 4]]
    assert compare_with_model(spectra(measured), beam(), NAMES, ["velocity", *KINDS[1:]]) == []


def test_reversed_channel_and_wrong_unit_are_detected():
    measured = beam(1.003)
    measured[2] *= -1.0
    measured[4] /= 9.80665
    rows = compare_with_model(spectra(measured), beam(), NAMES, KINDS)
    assert [(row["check"], row["channel"]) for row in rows] == [
        ("swapped channels", "y2"),
        ("units", "y4"),
    ]
    assert "polarity" in rows[0]["message"] and "between g and m s-2" in rows[1]["message"]


def test_silent_channel_is_not_checked():
    measured = beam()
    measured[3] *= -1.0
    quiet = spectra(measured)
    quiet.coherence[3] = 0.1
    assert compare_with_model(quiet, beam(), NAMES, KINDS) == []


def test_several_deviating_channels_mean_a_model_error():
    """Friction that holds the tube at the lowest level quietens many channels: none is left out for
    it.
    """
    rows = compare_with_model(
        spectra(beam(1.003) * np.array([0.2, 0.3, 1.0, 0.4, 1.0])[:, None]),
        beam(),
        NAMES,
        KINDS,
        "low",
    )
    assert [(row["check"], row["channel"]) for row in rows] == [
        ("gains", "y0"),
        ("gains", "y1"),
        ("gains", "y3"),
    ]
    assert (
        "Several channels are off" in rows[0]["message"]
        and "check its unit" not in rows[0]["message"]
    )


def test_noise_at_low_frequencies_is_no_other_unit():
    """Two thirds of the logarithmic bands of an accelerometer are noise, well above the model, and
    a fifth of its lines; where it follows the force it agrees.
    """
    measured, low = beam(1.005, 0.02), LINES < 50.0
    measured[1, low] += 3.0 * np.abs(measured[1, low]).max()
    coherence = np.full(measured.shape, 0.98)
    coherence[1, low] = 0.1

    def checks(response):
        ones = np.ones(len(response))
        found = compare_with_model(
            Transfer(LINES, response, coherence, ones, ones, 12, 5.0), beam(), NAMES, KINDS
        )
        return [(row["check"], row["channel"]) for row in found]

    assert checks(measured) == []
    measured[1] *= 10.0
    assert checks(measured) == [("units", NAMES[1])]


@pytest.mark.parametrize(("least", "most"), [(0.3, 60.0), (4.0, 40.0)])
def test_level_that_differs_from_band_to_band_is_no_unit(least, most):
    """From the least factor at 5 Hz to the most at 200 Hz, four and thirteen times in between."""
    measured = beam(1.005, 0.02)
    measured[1] *= least * (LINES / 5.0) ** (np.log(most / least) / np.log(40.0))
    assert compare_with_model(spectra(measured), beam(), NAMES, KINDS) == []
