"""Forces as recorders give them: with an offset, white to 0 Hz, blows of a hammer, a sine."""

import numpy as np
import pytest
import yaml
from scipy.signal import StateSpace, butter, lsim, sosfiltfilt

from docs.examples import hammer_test
from vibroimpact.campaign.checks.file_checks import NOT_CHECKED, check_campaign, refused
from vibroimpact.campaign.file import Channel, Level, campaign_dataset, force_signal
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.campaign.importing.report import checks_text
from vibroimpact.io.signal_files.signals import ImportProblem

RATE = 512.0
Y = (0.0, 1.0, 0.0)
AVERAGED = ["coherence", "delay", "swapped channels", "stationarity", "record length"]


def acceleration(force, rate=RATE, natural_Hz=40.0):
    """Of a mass of 2 kg on a spring with 2 % of critical damping, m/s², with a little noise."""
    pole = 2.0 * np.pi * natural_Hz
    row = [-(pole**2), -2.0 * 0.02 * pole]
    system = StateSpace([[0.0, 1.0], row], [[0.0], [0.5]], [row], [[0.5]])
    moved = lsim(system, force, np.arange(force.size) / rate)[1]
    return moved + 1e-3 * force.std() * np.random.default_rng(9).standard_normal(force.size)


def random_force(seconds, seed, band=(5.0, 150.0), rate=RATE):
    """Of 1 N RMS; white where no band is given."""
    force = np.random.default_rng(seed).standard_normal(int(seconds * rate))
    if band is not None:
        force = sosfiltfilt(butter(4, band, "band", fs=rate, output="sos"), force)
    return force / force.std()


def blows(seconds, noise=0.0):
    """Of a hammer every 4 s, in N: exact zeros between them without noise."""
    force = np.zeros(int(seconds * RATE))
    draw = np.random.default_rng(3)
    for start in range(int(0.5 * RATE), force.size - 8, int(4 * RATE)):
        force[start : start + 3] = 100.0 * np.array([0.5, 1.0, 0.5]) * draw.uniform(0.8, 1.2)
    return force + noise * draw.standard_normal(force.size)


def campaign(forces, offsets=(0.0, 0.0), rate=RATE, natural_Hz=40.0, **attributes):
    """Two records of the oscillator under forces whose cell reads an offset as well."""
    response = [acceleration(force, rate, natural_Hz)[None] for force in forces]
    read = [(force + offset)[None] for force, offset in zip(forces, offsets, strict=True)]
    tip = Channel("tip", (0.0, 0.0, 0.0), Y, "m s-2", "acceleration")
    drive = Channel("cell", (0.0, 0.0, 0.0), Y, "N", "force")
    levels = [Level("low", np.nan), Level("high", np.nan, split="holdout")]
    return campaign_dataset(read, response, [tip], [drive], levels, rate, **attributes)


def levels_of(signal):
    return [signal, 3.0 * signal]


def told(made, check=None):
    """{check: messages} of what does not pass; of one check its messages."""
    rows = [row for row in check_campaign(made) if row["level"] != "pass"]
    found = {row["check"]: [] for row in rows}
    for row in rows:
        found[row["check"]].append(row["message"])
    return found if check is None else found.get(check, [])


@pytest.mark.parametrize("offsets", [(20.0, 20.0), (20.0, 5.0), (3.0, -3.0), (1.0, 1.0)])
def test_an_offset_of_the_force_is_told_and_is_no_load(offsets):
    made = campaign([random_force(40.0, 1), 3.0 * random_force(40.0, 2)], offsets)
    np.testing.assert_allclose(made["load_rms"].values, [1.0, 3.0], rtol=1e-6)
    found = told(made)
    assert set(found) == {"load_rms", "swapped channels"}  # of one response none can be swapped
    assert [text.split(" N in record")[0] for text in found["load_rms"]] == [
        f"cell reads a constant {offset:.4g}" for offset in found_offsets(made)
    ]
    np.testing.assert_allclose(found_offsets(made), offsets, atol=0.02)


def found_offsets(made):
    return np.median(made["force"].values[:, 0].astype(float), axis=-1)


def write(folder, forces, **drive):
    for name, force in zip(("low", "high"), forces, strict=True):
        table = np.stack([np.arange(force.size) / RATE, force, acceleration(force)], axis=1)
        np.savetxt(
            folder / f"{name}.csv",
            table,
            delimiter=",",
            fmt=("%.5g", "%.9g", "%.9g"),
            header="time [s],cell [N],tip [m/s^2]",
            comments="",
        )
    place = {"point_m": [0, 0, 0], "direction": "+y"}
    described = {
        "forces": [{"name": "cell", **place, **drive}],
        "channels": [{"name": "tip", "kind": "acceleration", **place}],
        "records": [{"file": "low.csv"}, {"file": "high.csv", "split": "holdout"}],
    }
    (folder / "campaign.yaml").write_text(yaml.safe_dump(described))


def test_an_offset_is_taken_out_where_that_is_asked_for(tmp_path):
    forces = levels_of(random_force(20.0, 1))
    write(tmp_path, [force + 20.0 for force in forces], remove_offset=True)
    made, rows = import_folder(tmp_path)
    np.testing.assert_allclose(force_signal(made, 1), forces[1], atol=0.2)
    assert abs(np.median(force_signal(made, 1))) < 1e-5
    assert "its offset of 20" in rows[0]["note"] and "load_rms" not in told(made)


def test_times_rounded_to_a_millisecond_are_even(tmp_path):
    """512 Hz with five digits: half a step off from 10 s on."""
    force = random_force(12.0, 1, band=None)
    write(tmp_path, levels_of(force))
    made, rows = import_folder(tmp_path)
    assert made.attrs["sampling_frequency"] == RATE
    np.testing.assert_allclose(force_signal(made, 0), force, rtol=1e-6)
    assert rows[0]["note"] == "times are rounded to 0.001 s: taken as even, at 512 Hz"


def test_the_load_is_that_of_the_stated_band():
    force = random_force(40.0, 1)
    drift = 5.0 * np.sin(2.0 * np.pi * 0.5 * np.arange(force.size) / RATE)
    forces = [force + drift, 3.0 * force + drift]
    made = campaign(forces, band_Hz=(4.0, 200.0))
    np.testing.assert_allclose(made["load_rms"].values, [1.0, 3.0], rtol=0.01)
    assert campaign(forces)["load_rms"].values[0] == pytest.approx(3.67, abs=0.02)
    assert "load_rms" not in told(made)


@pytest.mark.parametrize("band", [(200.0, 4.0), (4.0, 300.0), "4 to 200"])
def test_a_band_that_can_not_be_is_refused(band):
    made = campaign(levels_of(random_force(4.0, 1))).assign_attrs(band_Hz=band)
    assert told(made)["contract"][0].startswith("band_Hz = ")


@pytest.mark.parametrize("band", [[200.0, 4.0], [4.0]])
def test_a_wrong_band_of_the_sidecar_is_refused(tmp_path, band):
    write(tmp_path, levels_of(random_force(4.0, 1)))
    path = tmp_path / "campaign.yaml"
    path.write_text(path.read_text() + yaml.safe_dump({"band_Hz": band}))
    with pytest.raises(ImportProblem, match="band_Hz"):
        import_folder(tmp_path)


def test_a_white_force_is_usable_from_where_averages_do():
    made = campaign(levels_of(random_force(12.0, 1, band=None)))
    assert not refused(check_campaign(made))
    assert told(made, "record length")[0] == (
        "Record low of 12 s is sure from 3.01 Hz up. The force excites 0.542 Hz and above: state"
        " band_Hz: [3.01, 255.7] in campaign.yaml, or record 289 s."
    )
    stated = campaign(levels_of(random_force(12.0, 1, band=None)), band_Hz=(3.01, 255.7))
    assert set(told(stated)) == {"swapped channels"}


@pytest.mark.parametrize("seconds, enough", [(250.0, False), (290.0, True)])
def test_the_advised_length_is_enough(seconds, enough):
    force = random_force(seconds, 1, band=None, rate=64.0)
    made = campaign(levels_of(force), rate=64.0, natural_Hz=10.0)
    assert (told(made, "record length") == []) == enough


def test_a_record_of_few_periods_of_the_mode_is_refused():
    force = random_force(0.9, 1, band=None)
    made = campaign(levels_of(force), natural_Hz=6.0)
    message = told(made, "record length")[-1]
    assert refused(check_campaign(made)) and "10 periods of the lowest frequency" in message


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_blows_of_a_hammer_are_no_drop_out(noise):
    made = campaign(levels_of(blows(24.0, noise)))
    found = told(made)
    assert set(found) == {"record length", "swapped channels"} and not refused(check_campaign(made))


def test_a_random_force_that_drops_out_is_told():
    force = random_force(24.0, 1)
    force[5000:7000] = 0.0
    assert "cell is held or vanishes at 9.77 s" in told(campaign(levels_of(force)))["drop-outs"][0]


def test_one_blow_is_not_averaged():
    found = told(campaign(levels_of(blows(3.0))))
    assert set(found) == set(AVERAGED)
    assert "holds 1 of the 3 blows" in found["coherence"][0]


def test_checks_that_a_sine_does_not_allow_are_not_checked():
    force = np.sqrt(2.0) * np.sin(2.0 * np.pi * 4.8 * np.arange(8 * 512) / RATE)
    made = campaign(levels_of(force))
    rows = check_campaign(made)
    assert [row["check"] for row in rows if row["level"] == NOT_CHECKED] == AVERAGED
    text = checks_text(rows)
    assert f"{', '.join(AVERAGED)}: Not checked: cell excites" in text and "as a sine does" in text
    assert f"0 refusals, {len(AVERAGED)} not checked" in text


def test_a_file_without_time_is_not_checked_for_it():
    made = campaign(levels_of(random_force(20.0, 1))).drop_vars("time")
    assert told(made, "time") == ["Not checked: the file has no variable time."]


def two_close_modes(force):
    """(2, time) accelerations of two masses of 2 kg, driven at the first, with modes at 40.0 and
    40.6 Hz of 1.0 and 1.5 % of damping: real modes, since the damping is proportional to each.
    """
    shapes = np.array([[1.0, 1.0], [1.0, -1.0]]) / 2.0  # of unit modal mass
    poles, ratios = 2.0 * np.pi * np.array([40.0, 40.6]), np.array([0.01, 0.015])
    lines = np.fft.rfft(force)
    s = 2j * np.pi * np.fft.rfftfreq(force.size, 1.0 / RATE)
    modal = s**2 / (s**2 + 2.0 * (ratios * poles)[:, None] * s + (poles**2)[:, None])
    return np.fft.irfft(shapes @ (shapes[0][:, None] * modal) * lines, force.size)


@pytest.mark.parametrize("lag", [0, 3])
def test_damping_that_couples_close_modes_is_no_delay(lag):
    """Far from the modes the second mass leads by 1.4 ms, as a delay of its channel would do."""
    forces = levels_of(random_force(60.0, 1, (10.0, 120.0)))
    response = np.array([two_close_modes(force) for force in forces])
    response[:, 1] = np.roll(response[:, 1], lag, axis=-1)
    response += 3e-3 * np.random.default_rng(4).standard_normal(response.shape)
    channels = [Channel(name, (0.0, 0.0, 0.0), Y, "m s-2", "acceleration") for name in "ab"]
    drive = Channel("cell", (0.0, 0.0, 0.0), Y, "N", "force")
    levels = [Level("low", np.nan), Level("high", np.nan, split="holdout")]
    made = campaign_dataset(
        [force[None] for force in forces], response, channels, [drive], levels, RATE
    )
    assert ("delay" in told(made)) == bool(lag)


def test_the_example_of_a_hammer_test_is_sound(tmp_path):
    hammer_test.main(tmp_path)
    made, rows = import_folder(tmp_path)
    assert told(made) == {}
    assert rows[0]["note"] == "its offset of 3 is taken out"
    zeros = force_signal(made, 0) == 0.0
    assert zeros.mean() > 0.9
