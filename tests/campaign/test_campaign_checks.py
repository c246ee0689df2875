"""The validator: nothing is said of sound campaigns, and each fault put into one is told at its
record and channel.
"""

from pathlib import Path

import numpy as np
import pytest

from vibroimpact.campaign.checks.file_checks import (
    CHECKS,
    NOT_CHECKED,
    check_campaign,
    check_file,
    refused,
    usable_signals,
)
from vibroimpact.campaign.checks.linear_record import INCOHERENT, mean_coherence
from vibroimpact.campaign.checks.signal_faults import clipped_share
from vibroimpact.campaign.checks.stated import COLUMNS
from vibroimpact.campaign.file import Channel, Level, campaign_dataset, read_campaign
from vibroimpact.campaign.signals import campaign_signals, transfer
from vibroimpact.io.records import write_record

DEVELOPMENT = Path(__file__).parents[2].parent / "shared" / "data" / "campaigns"
NAMES = ("dev_null", "dev_gap", "dev_friction", "dev_offset", "dev_foliate")
RATE, SECONDS = 1024.0, 25.0
FREQUENCIES, DAMPING = np.array([8.0, 21.0, 47.0, 90.0]), np.array([0.02, 0.015, 0.004, 0.004])
# Of the span of a beam whose shapes are sines; the force acts at 0.35.
PLACES = np.array([0.13, 0.3, 0.42, 0.61, 0.8])


def made_up():
    """A beam of four modes with a force in y: five accelerometers along it and one across, at rest
    but for noise; three levels.
    """
    draw, samples = np.random.default_rng(7), int(RATE * SECONDS)
    lines = np.fft.rfftfreq(samples, 1.0 / RATE)
    omega, poles = 2.0 * np.pi * lines[:, None], 2.0 * np.pi * FREQUENCIES
    modal = 1.0 / (poles**2 - omega**2 + 2j * DAMPING * poles * omega)
    orders = np.arange(1, 5)
    shapes = np.sin(np.pi * np.outer(PLACES, orders)) * np.sin(0.35 * np.pi * orders)
    transfer = -(omega**2) * (modal @ shapes.T)
    force, response = [], []
    for load in (0.5, 2.0, 8.0):
        spectrum = np.fft.rfft(draw.standard_normal(samples)) * ((lines > 5.0) & (lines < 200.0))
        values = np.fft.irfft(spectrum, samples)
        scale = load / np.sqrt(np.mean(values**2))
        force.append(scale * values[None])
        moving = np.fft.irfft((scale * spectrum[:, None] * transfer).T, samples, axis=-1)
        response.append(
            np.vstack([moving, np.zeros((1, samples))]) + 0.003 * draw.standard_normal((6, samples))
        )
    channels = [
        Channel(f"y{index}", (place, 0.0, 0.0), (0.0, 1.0, 0.0), "m s-2", "acceleration")
        for index, place in enumerate(PLACES)
    ]
    channels.append(Channel("x2", (PLACES[2], 0.0, 0.0), (1.0, 0.0, 0.0), "m s-2", "acceleration"))
    drive = Channel("shaker", (0.35, 0.0, 0.0), (0.0, 1.0, 0.0), "N", "generic")
    levels = [Level("low", 2e-4), Level("middle", 2e-4), Level("high", 2e-4, split="holdout")]
    return campaign_dataset(force, response, channels, [drive], levels, RATE)


def named(name):
    """A sound campaign: the one made here, or one of another code."""
    file = DEVELOPMENT / f"{name}.nc"
    if name == "made up":
        return made_up()
    if not file.is_file():
        pytest.skip(f"{name}.nc of shared/data/campaigns is not in {DEVELOPMENT}: put it there")
    return read_campaign(file).copy(deep=True)


@pytest.fixture(params=["made up", "dev_gap"])
def sound(request):
    """A sound campaign to put faults into."""
    return named(request.param)


def complaints(campaign):
    """The rows of a campaign that do not pass."""
    rows = check_campaign(campaign)
    assert all(
        tuple(row) == COLUMNS
        and row["level"] in ("pass", "warn", "refuse", NOT_CHECKED)
        and row["message"].endswith(".")
        for row in rows
    )
    assert {row["check"] for row in rows} == set(CHECKS) or refused(rows)
    return [row for row in rows if row["level"] != "pass"]


def told(campaign, *keys, check=None):
    """The values of some keys of the complaints, or of those of one check."""
    rows = [row for row in complaints(campaign) if check in (None, row["check"])]
    return [tuple(row[key] for key in keys) for row in rows]


PLACE = ("check", "record", "channel")
CHANNEL = ("check", "channel")


@pytest.mark.parametrize("name", ["made up", *NAMES])
def test_sound_campaign_passes_every_check(name):
    assert complaints(named(name)) == []


@pytest.mark.parametrize("record, channel", [(0, 0), (2, 3), (1, 4)])
def test_clipping_is_detected(sound, record, channel):
    values = sound["response"].values[record, channel]
    limit = 0.6 * np.abs(values).max()
    sound["response"].values[record, channel] = np.clip(values, -limit, limit)
    assert told(sound, *PLACE) == [("clipping", *names(sound, record, channel))]


def test_clipping_followed_by_noise_is_detected(sound):
    values = sound["response"].values[2, 1]
    limit = 0.6 * np.abs(values).max()
    sound["response"].values[2, 1] = np.clip(
        values, -limit, limit
    ) + 1e-3 * limit * np.random.default_rng(3).standard_normal(values.size)
    assert told(sound, *PLACE) == [("clipping", *names(sound, 2, 1))]


def test_round_tops_are_not_clipping():
    draw, count = np.random.default_rng(1), np.arange(200_000)
    for signal in (
        np.sin(0.0123 * count),
        np.sin(0.0123 * count).astype(np.float32),
        np.round(100.0 * np.sin(0.0123 * count)),
        draw.standard_normal(count.size),
        np.round(20.0 * draw.standard_normal(count.size)),
        draw.standard_normal(count.size) ** 3,
    ):
        assert clipped_share(signal) is None
        limit = 0.7 * np.abs(signal).max()
        assert clipped_share(np.clip(signal, -limit, limit)) is not None


def test_a_few_sampled_crests_are_not_clipping():
    signal = 0.1 * np.random.default_rng(4).standard_normal(20_000)
    for number, crest in enumerate(([0.9, 0.985, 0.99, 1.0, 0.995, 0.9], [0.9, 0.984, 0.9])):
        for place in (2_000, 9_000):
            start = place + 500 * number
            signal[start : start + len(crest)] = crest
    assert clipped_share(signal) is None


def with_loads_of_the_force(campaign):
    """Write the RMS of the force to load_rms."""
    force = campaign["force"].values[:, 0].astype(float)
    campaign["load_rms"].values[:] = np.sqrt(np.mean(force**2, axis=-1))


def periodic(stated, clip=None):
    """made_up's beam under a multisine of 3000 samples, eight periods and a part, waves in place of
    its motion; stated: whether the file says so.
    """
    campaign = made_up()
    count, period = campaign.sizes["time"], 3000
    lines = np.zeros(period // 2 + 1, complex)
    lines[15:500] = np.exp(2j * np.pi * np.random.default_rng(5).uniform(size=485))
    for record, load in enumerate((0.5, 2.0, 8.0)):
        signals = (campaign["force"].values[record, 0], *campaign["response"].values[record, :5])
        for values, turn in zip(signals, (1, 1, 2j, -1, 1j, 3), strict=True):
            wave = np.fft.irfft(turn * lines, period)
            values[:] = np.resize(load * wave / wave.std(), count)
    if clip is not None:
        values = campaign["response"].values[clip]
        campaign["response"].values[clip] = np.clip(values, -0.7 * values.max(), 0.7 * values.max())
    with_loads_of_the_force(campaign)
    return campaign.assign_attrs(period_samples=period if stated else 0)


@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.parametrize("clip", [None, (1, 2)])
def test_only_a_clipped_periodic_record_is_clipping(stated, clip):
    campaign = periodic(stated, clip)
    expected = [] if clip is None else [names(campaign, *clip)]
    assert told(campaign, "record", "channel", check="clipping") == expected


@pytest.mark.parametrize("fill", ["zero", "held", "noise"])
@pytest.mark.parametrize("start", [1.3, 11.3])
def test_drop_out_is_detected(sound, fill, start):
    values, rate = sound["response"].values[1, 2], sound.attrs["sampling_frequency"]
    part = slice(int(start * rate), int((start + 0.5) * rate))
    values[part] = {
        "zero": 0.0,
        "held": values[part.start],
        "noise": (
            1e-4 * values.std() * np.random.default_rng(2).standard_normal(part.stop - part.start)
        ),
    }[fill]
    ((*place, message),) = told(sound, *PLACE, "message")
    assert place == ["drop-outs", *names(sound, 1, 2)] and f"at {int(start)}." in message


def test_rest_before_the_first_motion_is_no_drop_out():
    campaign = made_up()
    campaign["response"].values[:, :, :1500] = 0.0
    campaign["force"].values[:, :, :1500] = 0.0
    with_loads_of_the_force(campaign)
    assert told(campaign.assign_attrs(start_up="rest"), check="drop-outs") == []
    records = {record for (record,) in told(campaign, "record", check="drop-outs")}
    assert records == {"low", "middle", "high"}


def test_late_onset_of_motion_is_no_drop_out():
    # Whirl in the plane grows out of the noise long after the start.
    campaign = made_up()
    grown = 1e-4 + 1.0 / (1.0 + np.exp(-3.0 * (campaign["time"].values - 8.0)))
    campaign["response"].values[1, 5] = grown * np.random.default_rng(9).standard_normal(grown.size)
    assert told(campaign.assign_attrs(start_up="rest"), check="drop-outs") == []


@pytest.mark.parametrize("samples", [2, 3, 5, -4])
@pytest.mark.parametrize("channel", [0, 3])
def test_channel_delay_is_detected(sound, samples, channel):
    response = sound["response"].values
    response[:, channel] = np.roll(response[:, channel], samples, axis=-1)
    ((*place, message),) = told(sound, *CHANNEL, "message")
    assert place == ["delay", names(sound, 0, channel)[1]]
    word = "lags" if samples > 0 else "leads"
    assert f"{word} the other channels by {abs(samples):.1f} samples" in message


def test_delayed_force_is_detected(sound):
    sound["force"].values[:] = np.roll(sound["force"].values, 3, axis=-1)
    ((*place, message),) = told(sound, *CHANNEL, "message")
    assert place == ["delay", str(sound["force_channel_name"].values[0])]
    assert "All responses lead" in message and "3.0 samples" in message


def test_missing_samples_exclude_the_signal(sound):
    sound["response"].values[2, 1, 5000:5100] = np.nan
    sound["force"].values[1, 0, 7000] = np.inf
    rows = complaints(sound)
    force = names(sound, 1, 0)[0], str(sound["force_channel_name"].values[0])
    assert [tuple(row[key] for key in PLACE) for row in rows] == [
        ("gaps in time", *force),
        ("gaps in time", *names(sound, 2, 1)),
    ]
    force, response = usable_signals(sound, rows)
    assert force.tolist() == [index != 1 for index in range(force.size)]
    assert np.argwhere(~response).tolist() == [[2, 1]]


def test_swapped_axes_are_detected(sound):
    directions = sound["channel_direction"].values
    across = int(np.argmax(np.abs(directions[:, 0])))
    along = int(np.argmax(np.abs(directions[:, 1])))
    sound["response"].values[:, [across, along]] = sound["response"].values[:, [along, across]]
    found = complaints(sound)
    assert [(row["check"], row["channel"]) for row in found] == [
        ("swapped channels", names(sound, 0, channel)[1]) for channel in (along, across)
    ]
    assert f"{names(sound, 0, across)[1]}, which lies across the force, does" in found[0]["message"]


def test_swapped_channels_of_two_kinds_are_detected(sound):
    """With one channel along the force beside them, and a unit that says nothing of their power."""
    directions = sound["channel_direction"].values
    across = int(np.argmax(np.abs(directions[:, 0])))
    along, beside = np.argsort(-np.abs(directions[:, 1]), kind="stable")[:2].tolist()
    sound["response"].values[:, [across, along]] = sound["response"].values[:, [along, across]]
    few = sound.isel(channel=[along, beside, across])
    few["channel_kind"].values[2] = "displacement"
    few["channel_units"].values[2] = "m"
    expected = [(names(sound, 0, channel)[1],) for channel in (along, across)]
    assert told(few, "channel", check="swapped channels") == expected


def test_a_noisy_channel_is_not_taken_for_a_swapped_one(sound):
    """Of a displacement, only the lowest modes are above its noise: its mean coherence is low."""
    along = int(np.argmax(np.abs(sound["channel_direction"].values[:, 1])))
    response = np.nan_to_num(sound["response"].values[:, along])
    omega = 2.0 * np.pi * np.fft.rfftfreq(response.shape[-1], 1.0 / RATE)
    lines = np.fft.rfft(response) * (omega > 10.0) / np.maximum(omega, 10.0) ** 2
    moved = np.fft.irfft(lines, response.shape[-1])
    noise = 0.3 * moved.std(axis=-1, keepdims=True)
    moved += noise * np.random.default_rng(1).standard_normal(moved.shape)
    sound["response"].values[:, along] = moved
    sound["channel_kind"].values[along] = "displacement"
    sound["channel_units"].values[along] = "m"
    spectra = transfer(campaign_signals(sound), 0)
    assert mean_coherence(spectra)[along] < INCOHERENT < spectra.following[along]
    assert told(sound, check="swapped channels") == []


@pytest.mark.parametrize("wakes", [False, True])
def test_a_body_that_contact_alone_moves_is_not_dead(sound, wakes):
    along = int(np.argmax(np.abs(sound["channel_direction"].values[:, 1])))
    response = sound["response"].values
    size = 0.01 * np.nanstd(response[0, along])
    noise = size * np.random.default_rng(1).standard_normal(response[:, along].shape)
    moved = np.where(np.arange(len(noise))[:, None] > 0, response[:, along], 0.0) if wakes else 0.0
    response[:, along] = noise + moved + 0.0 * response[:, along]
    found = told(sound, "channel", check="swapped channels")
    assert found == ([] if wakes else [(names(sound, 0, along)[1],)])


@pytest.mark.parametrize("channel", [0, 3])
def test_reversed_channel_is_detected(sound, channel):
    sound["response"].values[:, channel] *= -1.0
    assert told(sound, *CHANNEL) == [("swapped channels", names(sound, 0, channel)[1])]


@pytest.mark.parametrize("units", ["m s-1", "mm", "bananas", ""])
def test_wrong_unit_excludes_the_channel(sound, units):
    sound["channel_units"].values[2] = units
    rows = complaints(sound)
    assert told(sound, *PLACE) == [("units", None, names(sound, 0, 2)[1])]
    left_out = np.argwhere(~usable_signals(sound, rows)[1])[:, 1].tolist()
    assert left_out == [2] * sound.sizes["record"]


def test_drifting_level_is_detected(sound):
    grow = np.linspace(0.6, 1.6, sound.sizes["time"])
    sound["response"].values[1] *= grow.astype(np.float32)
    found = set(told(sound, "check", "record"))
    assert found == {("stationarity", str(sound["record_name"].values[1]))}


def test_wrong_load_is_detected(sound):
    sound["load_rms"].values[1] *= 1.05
    assert told(sound, "check", "record") == [("load_rms", str(sound["record_name"].values[1]))]


def test_force_with_another_clock_is_refused(sound):
    sound["force"].values[:] = sound["force"].values[..., ::-1]
    assert ("refuse",) in told(sound, "level", check="coherence")


def test_uneven_time_and_wrong_rate_are_refused(sound):
    late = 0.2 * (np.arange(sound.sizes["time"]) > 900)
    uneven = sound.assign_coords(time=sound["time"].values + late)
    assert told(uneven, "check", "level") == [("time", "refuse")]
    slow = sound.assign_attrs(sampling_frequency=500.0)
    assert ("time", "refuse") in told(slow, "check", "level")


def test_one_level_is_refused_no_holdout_warns(sound):
    one = sound.isel(record=[1])
    assert set(told(one, "level", check="content")) == {("refuse",), ("warn",)}
    assert refused(check_campaign(one)) and not refused(check_campaign(sound))


def test_missing_attributes_get_reported_defaults(tmp_path):
    bare = made_up().drop_vars(["load_rms", "repeat", "split", "record_name"])
    bare["response"].values[1, :, -700:], bare["force"].values[1, :, -700:] = np.nan, np.nan
    write_record(bare, tmp_path / "bare.nc")
    campaign, rows = check_file(tmp_path / "bare.nc")
    samples = int(RATE * SECONDS)
    assert campaign["valid_samples"].values.tolist() == [samples, samples - 700, samples]
    np.testing.assert_allclose(campaign["load_rms"].values, [0.5, 2.0, 8.0], rtol=0.02)
    warned = [row["check"] for row in rows if row["level"] == "warn"]
    assert warned == ["contract"] * 5 + ["content"]
    assert not refused(rows)


def test_a_file_that_is_no_campaign_is_one_refusal(tmp_path):
    (tmp_path / "text.nc").write_text("nothing")
    campaign, rows = check_file(tmp_path / "text.nc")
    assert campaign is None and [(row["check"], row["level"]) for row in rows] == [
        ("contract", "refuse")
    ]
    write_record(made_up().drop_vars("gap"), tmp_path / "incomplete.nc")
    campaign, rows = check_file(tmp_path / "incomplete.nc")
    assert campaign is None and "no variable 'gap'" in rows[0]["message"]


def names(campaign, record, channel):
    """The names of a record and a channel."""
    places = ("record_name", record), ("channel_name", channel)
    return tuple(str(campaign[key].values[place]) for key, place in places)


def with_kind(campaign, channels, kind, units, of_lines):
    """The campaign with some channels of another kind, their lines by of_lines(lines, omega)."""
    campaign = campaign.copy(deep=True)
    rate = float(campaign.attrs["sampling_frequency"])
    values = campaign["response"].values.astype(float)
    omega = 2.0 * np.pi * np.fft.rfftfreq(values.shape[-1], 1.0 / rate)
    lines = of_lines(np.fft.rfft(values[:, channels], axis=-1), np.maximum(omega, 1.0))
    values[:, channels] = np.fft.irfft(lines, values.shape[-1], axis=-1)
    campaign["response"] = (campaign["response"].dims, values)
    campaign["channel_kind"].values[channels] = kind
    campaign["channel_units"].values[channels] = units
    return campaign


@pytest.mark.parametrize("velocities", [[0, 2], [0, 1, 2, 3, 4]])
def test_reversed_channel_is_detected_among_velocities(velocities):
    kinds = with_kind(made_up(), velocities, "velocity", "m s-1", lambda a, omega: a / (1j * omega))
    assert complaints(kinds) == []
    kinds["response"].values[:, 2] *= -1.0
    assert told(kinds, *CHANNEL) == [("swapped channels", "y2")]


@pytest.mark.parametrize("resolution", [0.0, 0.05])
def test_a_load_cell_without_contact_is_no_fault(resolution):
    """Along the force and silent at the lowest level, in bursts above it; with the steps of its
    converter, which are the whole of its noise where nothing touches.
    """
    campaign = made_up()
    noise = 0.02 * np.random.default_rng(3).standard_normal((3, campaign.sizes["time"]))
    inside = np.arange(campaign.sizes["time"]) % 900 < 60
    hits = np.where(inside, np.abs(campaign["response"].values[:, 1]), 0.0)
    cell = np.array([0.0, 1.0, 4.0])[:, None] * hits + noise
    if resolution:
        cell = np.round(cell / resolution) * resolution
    campaign["response"].values[:, 4] = cell
    campaign["channel_kind"].values[4], campaign["channel_units"].values[4] = "contact_force", "N"
    assert [row for row in complaints(campaign) if row["channel"] == "y4"] == []
    assert usable_signals(campaign, complaints(campaign))[1].all()


def test_a_load_cell_beyond_its_range_is_clipped():
    campaign = made_up()
    cell = np.maximum(campaign["response"].values[:, 1], 0.0)
    campaign["response"].values[:, 4] = np.minimum(cell, 0.4 * cell.max(axis=-1, keepdims=True))
    campaign["channel_kind"].values[4], campaign["channel_units"].values[4] = "contact_force", "N"
    clipped = {record for (record,) in told(campaign, "record", check="clipping")}
    assert clipped == {"low", "middle", "high"}
