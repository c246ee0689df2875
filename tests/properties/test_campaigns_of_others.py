"""Campaign files as other programs write them: refused, or what was written, in SI units."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.properties.guarded import Tried, folder_of_example, guarded
from tests.properties.recorder_files import EITHER, REFUSED, RIGHT
from tests.properties.test_campaigns import model, read
from tests.support.sound_campaign import sound_campaign
from vibroimpact.campaign.file import CampaignError
from vibroimpact.campaign.signals import campaign_signals

UNITS = {"m s-2": 1.0, "m/s^2": 1.0, "mm/s2": 1e-3, "g": 9.80665, "ft/s^2": 0.3048, "N": 0, "": 0}
FORCE_UNITS = {"N": 1.0, "kN": 1e3, "lbf": 4.4482216152605, "V": 1.0, "m": 0.0, "kg": 0.0, "": 0.0}


@cache
def sound():
    """The campaign and its signals in SI, (record, channel, time)."""
    campaign = sound_campaign()
    signals = campaign_signals(campaign)
    return campaign, np.array(signals.force), np.array(signals.response)


def scaled(name, units):
    """A change: the values of a variable in another unit, which the file states."""

    def change(draw, campaign):
        unit = draw(st.sampled_from([*units]))
        texts = "channel_units" if name == "response" else "force_channel_units"
        campaign[texts].values[:] = unit
        if units[unit]:
            campaign[name].values[:] = campaign[name].values / units[unit]
        return campaign, RIGHT if units[unit] else REFUSED

    return change


def stored_as(draw, campaign):
    """The numbers as another type, packed, or in another order of bytes."""
    kind = draw(st.sampled_from(["f8", ">f4", ">f8", "packed"]))
    for name in ("force", "response"):
        values = campaign[name].values
        if kind == "packed":
            step = np.abs(values).max() / 3e4
            campaign[name].encoding = {"dtype": "i2", "scale_factor": step, "_FillValue": -32768}
        else:
            campaign[name] = (campaign[name].dims, values.astype(kind), campaign[name].attrs)
    return campaign, RIGHT


def axes(draw, campaign):
    """The axes of a variable in another order."""
    name = draw(st.sampled_from(["force", "response", "channel_point", "channel_direction"]))
    return campaign.assign({name: campaign[name].transpose(*campaign[name].dims[::-1])}), EITHER


def times(draw, campaign):
    """A time beside the sampling frequency, or a sampling frequency of another kind."""
    rate, count = campaign.attrs["sampling_frequency"], campaign.sizes["time"]
    time, units, stated, owed = {
        "even": (np.arange(count) / rate, "s", rate, RIGHT),
        "later": (np.arange(count) / rate + 5.0, "s", rate, EITHER),
        "in ms": (1e3 * np.arange(count) / rate, "ms", rate, EITHER),
        "in ms, said to be s": (1e3 * np.arange(count) / rate, "s", rate, REFUSED),
        "of another rate": (np.arange(count) / 1000.0, "s", rate, REFUSED),
        "reversed": (np.arange(count)[::-1] / rate, "s", rate, REFUSED),
        "rate in kHz": (np.arange(count) / rate, "s", rate / 1e3, REFUSED),
        "rate as a text": (np.arange(count) / rate, "s", f"{rate:g}", EITHER),
        "rate as an array": (np.arange(count) / rate, "s", np.array([rate]), EITHER),
        "rate and unit": (np.arange(count) / rate, "s", f"{rate:g} Hz", REFUSED),
        "no rate": (np.arange(count) / rate, "s", np.nan, REFUSED),
    }[draw(st.sampled_from(TIMES))]
    campaign = campaign.assign_coords(time=("time", time, {"units": units}))
    return campaign.assign_attrs(sampling_frequency=stated), owed


TIMES = ["even", "later", "in ms", "in ms, said to be s", "of another rate", "reversed"] + [
    f"rate {how}" for how in ("in kHz", "as a text", "as an array", "and unit")
]  # fmt: skip


def names(draw, campaign):
    """A name twice, empty, or one that is no name."""
    variable = draw(st.sampled_from(["channel_name", "record_name", "channel_kind", "split"]))
    word = draw(st.sampled_from(["tip 0", "low", "", " ", "holdout", "displacement", "a\nb", "1"]))
    values = campaign[variable].values.copy()
    values[-1] = word
    if variable.endswith("name"):
        owed = REFUSED if word in ("", " ", "a\nb", values[0]) else RIGHT
    else:
        owed = EITHER
    return campaign.assign({variable: (campaign[variable].dims, values)}), owed


def places(draw, campaign):
    """A point, direction or gap that is none."""
    name = draw(st.sampled_from(["channel_point", "channel_direction", "gap"]))
    value = draw(st.sampled_from([np.nan, np.inf, -1.0, 0.0, 1e30, 2.0]))
    values = campaign[name].values.copy()
    values[0] = value
    wrong = abs(value) > 1e3 or (name == "gap" and value in (-1.0, 2.0))
    return campaign.assign({name: (campaign[name].dims, values)}), REFUSED if wrong else EITHER


def lengths(draw, campaign):
    """valid_samples that a record has, or not."""
    value, owed = draw(
        st.sampled_from(
            [(4096, RIGHT), (4095, EITHER), (4097, REFUSED), (0, REFUSED), (-1, REFUSED)]
        )
    )
    return campaign.assign(valid_samples=("record", np.array([4096, 4096, value]))), owed


def file_forms(draw, campaign):
    """An unlimited time, compressed values, texts of letters."""
    how = draw(st.sampled_from(["unlimited", "compressed", "letters"]))
    if how == "unlimited":
        campaign.encoding["unlimited_dims"] = ("time",)
    elif how == "compressed":
        campaign["response"].encoding = {"zlib": True, "shuffle": True}
    else:
        for name in ("channel_name", "record_name", "channel_units"):
            campaign[name] = (campaign[name].dims, campaign[name].values.astype("S"))
    return campaign, RIGHT


CHANGES = (
    *(scaled("response", UNITS), scaled("force", FORCE_UNITS)),
    *(stored_as, axes, times, names, places, lengths, file_forms),
)


def test_campaigns_of_others_are_refused_or_right(reliability):
    tried = Tried()
    model()
    _, force, response = sound()

    @given(st.data())
    def check(data):
        campaign, owes = sound()[0].copy(deep=True), []
        form = data.draw(st.sampled_from(["NETCDF4", "NETCDF3_64BIT", "NETCDF3_CLASSIC"]))
        chosen = data.draw(st.lists(st.sampled_from(CHANGES), max_size=2, unique=True))
        # The form of a file is that of its last values: their scale, the length of their texts.
        chosen.sort(key=lambda change: change in (stored_as, file_forms))
        for change in chosen:
            campaign, owed = change(data.draw, campaign)
            owes.append(owed)
        told = [getattr(change, "__name__", "unit") for change in chosen], owes
        with folder_of_example() as folder:
            path = folder / "bench.nc"
            if file_forms in chosen:  # which the older form has not
                form = "NETCDF4"
            campaign.to_netcdf(path, engine="netcdf4", format=form)
            outcome, result = tried.add(
                guarded(lambda: read(path), CampaignError, [folder], ["bench.nc"])
            )
        if outcome == "refused":
            assert {*owes} - {RIGHT}, (told, result)
            return
        assert REFUSED not in owes, told
        found = campaign_signals(result[0])
        assert found.rate == pytest.approx(512.0), told
        for values, expected in ((found.force, force), (found.response, response)):
            for record, each in zip(values, expected, strict=True):
                np.testing.assert_allclose(
                    each[..., : record.shape[-1]], record, atol=1e-4 * np.abs(expected).max()
                )
        unit = np.abs(np.linalg.norm(found.directions, axis=-1) - 1.0) < 0.01
        assert unit.all() or any("unit vector" in row["message"] for row in result[1]), told

    check()
    reliability.inputs("campaign files of others: units, types, axes, times, names, places", tried)
