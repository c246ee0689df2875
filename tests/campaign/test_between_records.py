"""Records that contradict the others of their campaign, and nothing of those that do not."""

import numpy as np
import pytest

from tests.campaign.test_campaign_checks import made_up
from tests.support.sound_campaign import sound_campaign
from vibroimpact.campaign.checks.between_records import spike
from vibroimpact.campaign.checks.file_checks import check_campaign, usable_signals


def told(campaign, check="between records"):
    """(record, channel, message) of the warnings of a check."""
    rows = check_campaign(campaign)
    found = [row for row in rows if row["check"] == check and row["level"] == "warn"]
    return [(row["record"], row["channel"], row["message"]) for row in found]


def damaged(change):
    """The sound campaign with its middle record changed: change(force, response)."""
    campaign = made_up().copy(deep=True)
    change(campaign["force"].values[1], campaign["response"].values[1])
    return campaign


def swap(force, response):
    response[[0, 3]] = response[[3, 0]]


def swap_across(force, response):
    response[[0, 5]] = response[[5, 0]]


def scale(factor, channels=slice(None)):
    def change(force, response):
        response[channels] *= factor

    return change


def foreign_force(force, response):
    force[:] = np.roll(force, force.shape[-1] // 2, axis=-1)


@pytest.mark.parametrize(
    ("change", "channel", "part"),
    [
        (swap, "y0", "y0 and y3 are swapped in record middle against the others"),
        (swap_across, "y0", "y0 and x2 are swapped in record middle"),
        (scale(-1.0), "shaker", "All responses of record middle are reversed"),
        (scale(-1.0, 2), "y2", "y2 is reversed in record middle against the others"),
        (scale(9.80665), "shaker", "of record middle are 9.81 times those of the others"),
        (scale(1e-40), "shaker", "of record middle are 1e-40 times those of the others"),
        (scale(9.80665, 2), "y2", "y2 is 9.8"),
        (foreign_force, "shaker", "No response follows shaker in record middle"),
    ],
)
def test_a_record_that_contradicts_the_others_is_told(change, channel, part):
    [(record, accused, message)] = told(damaged(change))
    assert (record, accused) == ("middle", channel)
    assert part in message


@pytest.mark.parametrize("campaign", [made_up, sound_campaign])
def test_nothing_is_said_of_a_sound_campaign(campaign):
    assert told(campaign()) == told(campaign(), "spikes") == []


def test_copies_of_channels_and_records_are_told():
    def copy(force, response):
        response[3] = response[1]

    assert "y3 and y1 hold the same samples in record middle" in told(damaged(copy))[0][2]
    campaign = made_up().copy(deep=True)
    for name in ("force", "response"):
        campaign[name].values[2] = campaign[name].values[0]
    assert any("Record high holds the samples of record low" in row[2] for row in told(campaign))


def test_a_single_sample_beyond_all_leaves_its_channel_out():
    def hit(force, response):
        response[1, 700] = 1e14

    campaign = damaged(hit)
    [(record, channel, message)] = told(campaign, "spikes")
    assert (record, channel) == ("middle", "y1") and "1e+14 (SI) at 0.684 s" in message
    usable = usable_signals(campaign, check_campaign(campaign))[1]
    assert not usable[1, 1] and usable.sum() == usable.size - 1


def test_blows_and_decays_are_no_spikes():
    time = np.arange(4096) / 1024.0
    blow = np.where((time > 1.0) & (time < 1.005), np.sin(np.pi * (time - 1.0) / 0.005), 0.0)
    decay = np.where(time > 1.0, np.exp(-5.0 * (time - 1.0)) * np.cos(200.0 * time), 0.0)
    assert spike(blow) is None and spike(decay) is None
    assert spike(np.random.default_rng(1).standard_normal(4096)) is None
