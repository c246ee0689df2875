"""Input power against a closed form, and where it can not be told."""

import numpy as np
import pytest
import xarray as xr

from vibroimpact.discrepancy.power_balance import drive_channel, input_power

RATE, SECONDS = 1024.0, 64.0


def test_damper_power_is_force_squared_over_its_constant():
    force = np.random.default_rng(1).standard_normal(int(RATE * SECONDS))
    spectrum, omega = np.fft.rfft(force), 2.0 * np.pi * np.fft.rfftfreq(len(force), 1.0 / RATE)
    inside = (omega > 2.0 * np.pi * 20.0) & (omega < 2.0 * np.pi * 200.0)
    force = np.fft.irfft(np.where(inside, spectrum, 0.0), len(force))
    velocity = np.fft.rfft(force) / 50.0  # through a damper of 50 N s/m
    acceleration = np.fft.irfft(1j * omega * velocity, len(force))
    displacement = np.fft.irfft(velocity / np.where(inside, 1j * omega, 1.0), len(force))
    for kind, response in (
        ("acceleration", acceleration),
        ("velocity", np.fft.irfft(velocity, len(force))),
        ("displacement", displacement),
    ):
        assert input_power(force, response, kind, RATE, (10.0, 210.0)) == pytest.approx(
            np.mean(force**2) / 50.0, rel=0.02
        )
        assert (
            input_power(force, np.roll(response, 3), kind, RATE, (10.0, 210.0))
            < 0.9 * np.mean(force**2) / 50.0
        )


def test_a_spring_takes_no_power():
    force = np.random.default_rng(2).standard_normal(int(RATE * SECONDS))
    assert input_power(force, force / 1.0e3, "displacement", RATE, (10.0, 210.0)) == pytest.approx(
        0.0, abs=1.0e-12
    )


def campaign(point, direction, kind="velocity"):
    return xr.Dataset(
        {
            "channel_point": (("channel", "xyz"), [[0.0, 0.0, 1.0], point]),
            "channel_direction": (("channel", "xyz"), [[0.0, 1.0, 0.0], direction]),
            "channel_kind": ("channel", ["acceleration", kind]),
            "force_channel_point": (("force_channel", "xyz"), [[0.2, 0.0, 0.9]]),
            "force_channel_direction": (("force_channel", "xyz"), [[0.0, 1.0, 0.0]]),
        }
    )


def test_drive_point_channel_is_found_with_its_sign():
    assert drive_channel(campaign([0.2, 0.0, 0.9], [0.0, -1.0, 0.0])) == (1, -1.0)
    assert drive_channel(campaign([0.2, 0.0, 0.9], [1.0, 0.0, 0.0])) is None
    assert drive_channel(campaign([0.2, 0.0, 0.8], [0.0, 1.0, 0.0])) is None
    assert drive_channel(campaign([0.2, 0.0, 0.9], [0.0, 1.0, 0.0], "contact_force")) is None
