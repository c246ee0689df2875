"""Generated campaign files: refused with file, variable and value, or read as they were written."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.properties.guarded import Tried, folder_of_example, guarded
from tests.support.sound_campaign import sound_campaign
from vibroimpact.campaign.checks.file_checks import check_file, refused, usable_signals
from vibroimpact.campaign.file import CampaignError, checked_description, measured_values
from vibroimpact.campaign.signals import campaign_signals
from vibroimpact.config.reading import load_config
from vibroimpact.diagnosis.identified.records import usable_records
from vibroimpact.diagnosis.measurement.comparable import comparison_problems
from vibroimpact.diagnosis.measurement.signals import signals_of
from vibroimpact.diagnosis.measurement.usable import Refused, usable

ROOT = Path(__file__).parents[2]
SMALL = ("gap", "channel_point", "channel_direction", "force_channel_point", "load_rms", "repeat")
TEXTS = ("channel_name", "record_name", "channel_units", "channel_kind", "split")
ATTRIBUTES = ("sampling_frequency", "period_samples", "transient_periods", "start_up", "antialias")
NUMBERS = st.sampled_from([np.nan, np.inf, -np.inf, 1e30, -1.0, 0.0, 1e-30, 0.289, 1000.0, 7.5])
WORDS = st.sampled_from(
    ["", "low", "tip 0", "shaker", "force", "m", "mm", "g", "furlong", "kg", "velocity", "generic"]
    + ["m s-1", "contact_force", "N", "holdout", "a/b", "a\nb", "$x$", "µm", "x" * 300, "1e400 m"]
) | st.text(max_size=8)
WILD = st.one_of(NUMBERS, st.sampled_from([0, 7, -64, 64, 512, 4097, 2**40]), WORDS)


@cache
def sound():
    """The campaign that is damaged."""
    return sound_campaign()


@cache
def model():
    """The tube that a campaign is compared with."""
    return load_config(ROOT / "config" / "smoke.yaml")


@st.composite
def damages(draw):
    """One change of a campaign Dataset, as a function."""
    kind = draw(st.sampled_from(sorted(CHANGES)))
    return CHANGES[kind](draw)


def _number(draw):
    name, value, place = draw(st.sampled_from(SMALL)), draw(NUMBERS), draw(st.integers(0, 8))

    def change(campaign):
        values = campaign[name].values.astype(float)
        values.flat[place % values.size] = value
        return campaign.assign({name: (campaign[name].dims, values, campaign[name].attrs)})

    return change


def _signal(draw):
    name, value = draw(st.sampled_from(["force", "response"])), draw(NUMBERS)
    record, channel, samples = (draw(st.integers(0, most)) for most in (2, 2, 4096))

    def change(campaign):
        out = campaign.copy(deep=True)
        values = out[name].values
        values[record % len(values), channel % values.shape[1], :samples] = value
        return out

    return change


def _text(draw):
    name, word, place = draw(st.sampled_from(TEXTS)), draw(WORDS), draw(st.integers(0, 2))

    def change(campaign):
        values = campaign[name].values.copy()
        values[place % len(values)] = word
        return campaign.assign({name: (campaign[name].dims, values)})

    return change


def _attribute(draw):
    name, value = draw(st.sampled_from(ATTRIBUTES)), draw(WILD)
    return lambda campaign: campaign.assign_attrs({name: value})


def _unit(draw):
    name, value = draw(st.sampled_from(("force", *SMALL))), draw(WILD)
    key = draw(st.sampled_from(["units", "scale_factor", "_FillValue", "valid_range"]))
    if key != "units":
        value = draw(st.sampled_from([0.0, 1000.0, np.inf, -1.0]))

    def change(campaign):
        out = campaign.copy()
        out[name].attrs = {**out[name].attrs, key: value}
        return out

    return change


def _type(draw):
    name = draw(st.sampled_from(("force", "response", "time", *SMALL, *TEXTS)))
    kind = draw(st.sampled_from([str, np.int32, np.int8, np.float32, bool]))

    def change(campaign):
        values = campaign[name].values
        try:
            values = values.astype(kind)
        except (TypeError, ValueError):  # a text that is no number
            values = np.zeros(values.shape, kind)
        return campaign.assign({name: (campaign[name].dims, values)})

    return change


def _form(draw):
    name = draw(st.sampled_from(("force", "response", "gap", "channel_point", *TEXTS)))
    dim = draw(st.sampled_from(["record", "channel", "force_channel", "time", "xyz"]))
    size = draw(st.sampled_from([0, 1, 2, 100, 1000]))
    return draw(
        st.sampled_from(
            [
                lambda campaign: campaign.drop_vars(name, errors="ignore"),
                lambda campaign: campaign.rename({name: f"{name}_2"}),
                lambda campaign: campaign.isel({dim: slice(0, size)}),
                lambda campaign: campaign.assign(
                    {name: campaign[name].transpose(*campaign[name].dims[::-1])}
                ),
                lambda campaign: campaign.assign({name: campaign[name].expand_dims("more")}),
            ]
        )
    )


def _optional(draw):
    name, dims = draw(
        st.sampled_from(
            [
                ("valid_samples", ("record",)),
                ("support_gap", ("record", "support")),
                ("noise_floor_rms", ("channel",)),
                ("voltage", ("record", "time")),
            ]
        )
    )
    value = draw(NUMBERS | st.sampled_from([-5, 0, 100, 2048, 4096, 5000]))
    sizes = {"record": 3, "channel": 3, "support": 2, "time": 4096}
    return lambda campaign: campaign.assign(
        {name: (dims, np.full([sizes[dim] for dim in dims], value))}
    )


CHANGES = {
    "number": _number,
    "signal": _signal,
    "text": _text,
    "attribute": _attribute,
    "unit": _unit,
    "type": _type,
    "form": _form,
    "optional": _optional,
}


def read(path):
    """Do what `vibroimpact check` and both kinds of diagnosis do before the first simulation.

    Returns (campaign, rows of checks). Raises CampaignError with the sentences of a refusal.
    """
    campaign, rows = check_file(path)
    if refused(rows):
        told = [row["message"] for row in rows if row["level"] == "refuse"]
        raise CampaignError("\n".join(f"{path}: {message}" for message in told))
    if not comparison_problems(model(), checked_description(path)):
        try:
            assert np.isfinite(signals_of(usable(path, model())[0]).load).all()
        except Refused as refusal:
            assert str(refusal)
    try:
        usable_records(path)
    except Refused as problem:
        assert str(problem).endswith(".")
    return campaign, rows


def is_right(campaign, written):
    """Assert that what is read of a file is what was written, in SI, under names of its own."""
    names = [*campaign["channel_name"].values, *campaign["force_channel_name"].values]
    assert len(set(names)) == len(names) and len(set(campaign["record_name"].values)) == len(
        campaign["record_name"]
    )
    gap = campaign["gap"].values.astype(float)
    assert np.all(np.isnan(gap) | ((gap >= 0.0) & (gap <= 1.0)))
    signals = campaign_signals(campaign)
    for record, response in enumerate(signals.response):
        stored = written["response"].values[record][:, : response.shape[-1]].astype(float)
        expected = np.where(np.abs(stored) <= 1e15, stored, np.nan) * signals.factors[:, None]
        np.testing.assert_allclose(response, expected, rtol=1e-6)


def test_damaged_campaigns_are_refused_or_read(reliability):
    tried = Tried()
    model()  # read before files are watched

    @given(st.lists(damages(), min_size=0, max_size=2))
    def holds(changes):
        campaign = sound()
        for change in changes:
            try:
                campaign = change(campaign)
            except (KeyError, ValueError, IndexError):  # what it changes is gone
                continue
        with folder_of_example() as folder:
            try:
                campaign.to_netcdf(folder / "bench.nc")
            except (TypeError, ValueError, AttributeError, OverflowError, RuntimeError):
                return  # no netCDF file can hold it
            outcome = guarded(
                lambda: read(folder / "bench.nc"), CampaignError, [folder], ["bench.nc"]
            )
            tried.add(outcome)
            packed = any(
                "scale_factor" in variable.attrs for variable in campaign.variables.values()
            )
            if outcome[0] == "right" and not packed:
                is_right(outcome[1][0], campaign)

    holds()
    reliability.inputs("campaign files: values, names, units, types, sizes", tried)


@cache
def stored():
    """The bytes of a sound campaign as netCDF-4 and as classic netCDF."""
    with folder_of_example() as folder:
        sound().to_netcdf(folder / "new.nc")
        sound().to_netcdf(folder / "classic.nc", format="NETCDF3_64BIT")
        return [(folder / name).read_bytes() for name in ("new.nc", "classic.nc")]


@st.composite
def broken_files(draw):
    """The bytes of a campaign file with some of them changed, cut off or repeated."""
    content = bytearray(draw(st.sampled_from(stored())))
    # Most of a file are samples; what describes them stands at its ends.
    place = st.integers(0, 4000) | st.integers(0, len(content) - 1)
    how = draw(st.sampled_from(["change", "cut", "blank", "other", "after"]))
    if how == "cut":
        return bytes(content[: draw(place)])
    if how == "other":
        return draw(st.binary(max_size=64)) + bytes(content[draw(place) :])
    if how == "after":
        return bytes(content) + draw(st.binary(max_size=64))
    for _ in range(draw(st.integers(1, 6))):
        at = draw(place)
        size = draw(st.sampled_from([1, 2, 8, 64]))
        new = bytes(size) if how == "blank" else draw(st.binary(min_size=size, max_size=size))
        content[at : at + size] = new
    return bytes(content)


@pytest.mark.filterwarnings("ignore:Generating overly large repr")
def test_broken_campaign_files_are_refused_or_read(reliability):
    tried = Tried()
    model()

    @given(broken_files())
    def holds(content):
        with folder_of_example() as folder:
            (folder / "bench.nc").write_bytes(content)
            outcome = guarded(
                lambda: read(folder / "bench.nc"), CampaignError, [folder], ["bench.nc"]
            )
            tried.add(outcome)

    holds()
    reliability.inputs("campaign files: bytes changed, blanked or cut off", tried)


def test_a_hole_excludes_its_own_record_and_channel(reliability):
    tried = Tried()

    @given(
        st.lists(
            st.text(st.characters(codec="utf-8", exclude_categories=("C", "Z")), min_size=1),
            min_size=7,
            max_size=7,
            unique=True,
        ),
        st.integers(0, 2),
        st.integers(0, 3),
        st.sampled_from([np.nan, np.inf, 1e30]),
    )
    def holds(names, record, channel, value):
        campaign = sound().copy(deep=True)
        campaign["record_name"].values[:] = names[:3]
        campaign["channel_name"].values[:] = names[3:6]
        campaign["force_channel_name"].values[:] = names[6:]
        name, index = ("force", 0) if channel == 3 else ("response", channel)
        campaign[name].values[record, index, 2000] = value
        with folder_of_example() as folder:
            campaign.to_netcdf(folder / "bench.nc")
            outcome = tried.add(
                guarded(lambda: check_file(folder / "bench.nc"), CampaignError, [folder])
            )
        force, response = usable_signals(*outcome[1])
        expected = np.ones((3, 4), bool)
        expected[record, channel] = False
        assert np.array_equal(np.column_stack([response, force]), expected)
        assert np.isnan(measured_values(outcome[1][0], name, record)[index, 2000])

    holds()
    reliability.inputs("campaign files: one sample that is no number", tried)
