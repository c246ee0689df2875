"""Figures of a diagnosis: what is drawn is what the evidence holds, for any number of sensors."""

import base64
import re

import numpy as np
import pytest
import xarray as xr

from tests.support.discrepancy_results import made_up_verdict
from tests.support.figure_layout import layout_faults
from vibroimpact.diagnosis.verdict.content import CONCLUSIONS, FoundEffect
from vibroimpact.reports.discrepancy_page import discrepancy_page
from vibroimpact.reports.figures.diagnosis.law import (
    force_error,
    median_law,
    pressed,
)
from vibroimpact.reports.figures.diagnosis.place import place_figure
from vibroimpact.reports.figures.diagnosis.psd import chosen_channels, psd_figure
from vibroimpact.reports.figures.diagnosis.sheets import diagnosis_figures
from vibroimpact.reports.figures.drawing import drawn
from vibroimpact.reports.figures.style import tidy_log_axes

GAP_M, STIFFNESS = 3.0e-4, 1.0e6
RATE_HZ = 2048.0
FIGURES = (
    "diagnosis_place",
    "diagnosis_holding",
    "diagnosis_law",
    "diagnosis_ranking",
    "diagnosis_free_sensor",
    "diagnosis_psd",
)


def stop(motion, gap):
    """The force in N of an elastic stop behind a gap on both sides."""
    return -STIFFNESS * np.sign(motion) * np.maximum(np.abs(motion) - gap, 0.0)


def made_up_evidence(channels=7, records=4, supports=2, known=1.0, after="gap@all"):
    """Evidence of a structure whose stops are at GAP_M, where the model as given has them at twice
    that.
    """
    draw = np.random.default_rng(3)
    time = np.arange(0.0, 2.0, 1.0 / RATE_HZ)
    places = 2 * supports
    place = np.arange(places)[:, None]
    largest = np.where(place % 2 == 0, 0.5, 1.4) * GAP_M  # x does not reach the stop
    motion = largest * np.sin(2.0 * np.pi * (17.0 + 3.0 * place) * time)
    demanded = stop(motion, GAP_M) + 2.0 * draw.standard_normal(motion.shape)
    law = np.stack([stop(motion, 2.0 * GAP_M), stop(motion, GAP_M)])
    holding = 10.0 ** draw.uniform(-2, 0, (2, records, channels, 10))
    holding[1] *= 0.2
    names = [f"sensor_{number:02d}_y" for number in range(channels)]
    error = draw.uniform(0.4, 0.9, (2, 1, channels))
    error[1] *= 0.2
    cycles = np.sin(2 * np.pi * 40.0 * time[:400])
    split = ["holdout" if row == records - 2 else "fit" for row in range(records)]
    return xr.Dataset(
        {
            "channel_name": ("channel", names),
            "channel_kind": ("channel", ["acceleration"] * channels),
            "channel_point": (("channel", "xyz"), draw.uniform(-1, 1, (channels, 3))),
            "channel_direction": (("channel", "xyz"), np.tile([0.0, 1.0, 0.0], (channels, 1))),
            "force_channel_point": (("force_channel", "xyz"), [[0.0, 0.0, 0.5]]),
            "force_channel_direction": (("force_channel", "xyz"), [[0.0, 1.0, 0.0]]),
            "record_name": ("stretch", [f"level_{row}" for row in range(records)]),
            "split": ("stretch", split),
            "part": ("stretch", ["apart" if each == "holdout" else "fitted" for each in split]),
            "load": ("stretch", 2.0 ** np.arange(records), {"units": "N"}),
            "start": ("stretch", np.ones(records), {"units": "s"}),
            "band_low": ("band", np.geomspace(4.0, 600.0, 11)[:-1]),
            "band_high": ("band", np.geomspace(4.0, 600.0, 11)[1:]),
            "holding_force": (("state", "stretch", "channel", "band"), holding, {"units": "N"}),
            "free_error": (("state", "free_stretch", "channel"), error),
            "free_of_stretch": ("free_stretch", [0]),
            "waveform": (
                ("series", "moment"),
                np.stack([cycles, 0.5 * cycles, 0.95 * cycles]),
                {"units": "m/s"},
            ),
            "moment_time": ("moment", 3.0 + time[:400]),
            "waveform_stretch": ((), 0),
            "waveform_channel": ((), channels - 1),
            **made_up_law(motion, demanded, law, supports, known),
        },
        coords={"state": ["before", "after"], "series": ["measured", "before", "after"]},
        attrs={"before": "nothing", "after": after},
    )


def made_up_law(motion, demanded, law, supports, known):
    """The variables of the law, none without supports."""
    if not supports:
        return {}
    owners = [f"plate_{number // 2}" for number in range(2 * supports)]
    names = [f"{owner}, {'xy'[number % 2]}" for number, owner in enumerate(owners)]
    dims = ("law_stretch", "place", "sample")
    return {
        "place_name": ("place", names),
        "owner_name": ("place", owners),
        "law_of_stretch": ("law_stretch", [0]),
        "resolution": (dims[:2], np.full((1, 2 * supports), known)),
        "demanded_force": (dims, demanded[None]),
        "demanded_motion": (dims, motion[None]),
        "model_force": (("state", *dims), law[:, None]),
        "model_motion": (("state", *dims), np.stack([motion, motion])[:, None]),
    }


def made_up_psd(channels=7, records=4):
    """Spectra of free runs: the channel before the last disagrees most, in every record."""
    frequency = np.arange(0.0, 1024.5, 1.0)
    one = 1.0 / ((1.0 - (frequency / 40.0) ** 2) ** 2 + (0.1 * frequency / 40.0) ** 2)
    psd = np.tile(one, (3, records, channels, 1))
    psd[1, :, max(channels - 2, 0)] *= 4.0
    psd[1, :, 0] *= 1.5
    return xr.Dataset(
        {
            "psd": (("state", "record", "channel", "frequency"), psd),
            "compared": (("record", "channel"), np.ones((records, channels), np.int8)),
            "load": ("record", 2.0 ** np.arange(records), {"units": "N"}),
            "record_name": ("record", [f"level_{row}" for row in range(records)]),
            "channel_name": ("channel", [f"sensor_{row:02d}_y" for row in range(channels)]),
            "channel_kind": ("channel", ["acceleration"] * channels),
            "split": ("record", ["holdout"] + ["fit"] * (records - 1)),
        },
        coords={"frequency": ("frequency", frequency, {"units": "Hz"})},
    )


def verdict_of(kind="named"):
    """A verdict of a kind with probabilities that agree with it."""
    values = made_up_verdict(kind).to_values()
    most = {"named": 0.9, "partly_explained": 0.3, "ambiguous": 0.5}.get(kind, 0.03)
    for row in values["ranking"]:
        row["probability"] = 0.01
    if values["ranking"]:
        values["ranking"][0]["probability"] = most
    if kind == "not_testable":
        return made_up_verdict(kind)
    return made_up_verdict(
        kind,
        ranking=values["ranking"],
        probability_none=0.9 if kind == "none" else 0.01,
        probability_something_else=0.9 if kind == "unknown" else 0.01,
    )


@pytest.fixture(scope="module")
def figures():
    """{name: Sheet} of a named effect."""
    sheets = [*map(drawn, diagnosis_figures(made_up_evidence(), made_up_psd(), verdict_of()))]
    return {sheet.name: sheet for sheet in sheets}


def test_axes_say_what_they_are_and_in_which_unit(figures):
    assert tuple(figures) == FIGURES
    for sheet in figures.values():
        assert sheet.caption.endswith(".") and sheet.tables
        shown = [axes.get_xlabel() for axes in sheet.axes.values() if axes.get_xlabel()]
        assert shown and all(label.endswith(")") for label in shown), sheet.name


@pytest.mark.parametrize("size", [(1, 2, 1), (40, 30, 5)], ids=("few", "many"))
def test_no_text_is_cut_or_covered(size):
    channels, records, supports = size
    evidence = made_up_evidence(channels, records, supports)
    sheets = [
        *map(drawn, diagnosis_figures(evidence, made_up_psd(channels, records), verdict_of()))
    ]
    for sheet in sheets:
        tidy_log_axes(sheet.figure)
    faults = {
        sheet.name: layout_faults(sheet.figure)
        for sheet in sheets
        if sheet.name != "diagnosis_place"  # of tests/reports/test_figure_layout
    }
    assert {name: found for name, found in faults.items() if found} == {}


def test_force_error_is_that_of_the_law():
    evidence = made_up_evidence()
    force = evidence["demanded_force"].values[0]
    assert force_error(evidence, 0, [1, 3]) == pytest.approx(1.0, abs=0.05)  # it never touches
    noise = 2.0 * np.sqrt(force[[1, 3]].size / np.sum(force[[1, 3]] ** 2))
    assert force_error(evidence, 1, [1, 3]) == pytest.approx(noise, rel=0.05)


def test_median_law_has_the_gap_and_the_stiffness():
    evidence = made_up_evidence()
    motion, force = (evidence[f"demanded_{name}"].values[0, 1] for name in ("motion", "force"))
    middle, median = median_law(motion, force)
    inside = np.abs(middle) < 0.9 * GAP_M
    assert np.abs(median[inside]).max() < 2.0
    beyond = middle > 1.1 * GAP_M
    slope, offset = np.polyfit(middle[beyond], median[beyond], 1)
    assert slope == pytest.approx(-STIFFNESS, rel=0.1)
    assert offset / STIFFNESS == pytest.approx(GAP_M, rel=0.1)
    touching = pressed(np.stack([0.0 * force, force]))
    assert np.abs(motion[touching]).min() > 0.95 * GAP_M


def test_table_of_the_law_is_what_the_sensors_demand(figures):
    rows = [row for row in figures["diagnosis_law"].rows() if row["curve"] == "demanded"]
    evidence = made_up_evidence()
    names = evidence["place_name"].values.tolist()
    shown = {row["place"] for row in rows}
    assert shown == {"plate_0, y", "plate_1, y"}  # the larger force of each support
    own = [row for row in rows if row["place"] == "plate_0, y"]
    place = names.index("plate_0, y")
    step = -(-evidence.sizes["sample"] // len(own))
    np.testing.assert_allclose(
        [row["place_force_N"] for row in own],
        evidence["demanded_force"].values[0, place, ::step],
        rtol=1e-5,
        atol=1e-5,
    )


def test_what_is_not_seen_is_told(figures):
    for evidence, words in (
        (made_up_evidence(known=0.2), "not seen by these sensors"),
        (made_up_evidence(supports=0), "The law at the supports"),
    ):
        sheets = [*map(drawn, diagnosis_figures(evidence, made_up_psd(), verdict_of()))]
        law = next(sheet for sheet in sheets if sheet.name == "diagnosis_law")
        assert words in law.figure.get_suptitle()
    alone = made_up_evidence().drop_vars(["free_error", "waveform"])
    sheets = [*map(drawn, diagnosis_figures(alone, made_up_psd(), verdict_of()))]
    assert next(each for each in sheets if each.name == "diagnosis_free_sensor").tables == []


def test_evidence_says_itself_what_it_can_not_give():
    told = made_up_evidence().drop_vars(["holding_force", "demanded_force", "free_error"])
    why = "the response is no motion"
    sheets = [
        *map(drawn, diagnosis_figures(told.assign_attrs(left_out=why), made_up_psd(), verdict_of()))
    ]
    silent = {sheet.name: sheet.caption for sheet in sheets if not sheet.tables}
    assert list(silent) == ["diagnosis_holding", "diagnosis_law", "diagnosis_free_sensor"]
    assert all(why in caption for caption in silent.values())


def test_a_failed_free_run_does_not_stop_the_figure():
    psd = made_up_psd()
    psd["psd"].values[1:] = np.nan
    sheet = drawn(psd_figure(psd, verdict_of()))
    tidy_log_axes(sheet.figure)
    assert layout_faults(sheet.figure) == []


def test_channels_that_are_not_compared_are_not_shown():
    psd = made_up_psd()
    assert chosen_channels(psd)[0] == 5
    psd["compared"].values[:, 5] = 0
    assert 5 not in chosen_channels(psd)


@pytest.mark.parametrize("kind", CONCLUSIONS)
def test_every_verdict_has_its_figures_and_page(kind, tmp_path):
    refused = kind == "not_testable"
    after = "nothing" if kind in ("none", "unknown") else "gap@all"
    evidence = xr.Dataset() if refused else made_up_evidence(2, 2, 1, after=after)
    psd = xr.Dataset() if refused else made_up_psd(1, 2)
    verdict = verdict_of(kind)
    sheets = [*map(drawn, diagnosis_figures(evidence, psd, verdict))]
    assert tuple(sheet.name for sheet in sheets) == FIGURES
    assert refused == all(not sheet.tables for sheet in sheets)
    shown = [sheet for sheet in sheets if sheet.tables and sheet.name == "diagnosis_ranking"]
    for sheet in shown:  # one, for time
        sheet.save(tmp_path)
    files = [tmp_path / f"{sheet.name}.png" for sheet in shown]
    page = discrepancy_page("dev <x>", verdict, files)
    assert "dev &lt;x&gt;" in page and not re.findall(r'(?:src|href)="(?!data:)', page)
    images = [base64.b64decode(image) for image in re.findall(r"base64,([^\"]+)", page)]
    assert images == [file.read_bytes() for file in files]


def with_points(channels):
    """A Dataset with the places of channels and of the force on the tube of the study."""
    return xr.Dataset(
        {
            "channel_name": ("channel", channels),
            "channel_point": (("channel", "xyz"), np.tile([0.0, 0.0, 1.0], (len(channels), 1))),
            "channel_direction": (("channel", "xyz"), np.tile([0.0, 1.0, 0.0], (len(channels), 1))),
            "force_channel_point": (("force_channel", "xyz"), [[-0.2121, 0.0, 0.9121]]),
            "force_channel_direction": (("force_channel", "xyz"), [[0.0, 1.0, 0.0]]),
        }
    )


@pytest.mark.parametrize(
    ("effect", "location", "marked"),
    [
        ("dry_friction", "all", [(-0.3, 0.35), (0.3, 0.35)]),
        ("gap", "left", [(-0.3, 0.35)]),
        ("added_mass", "apex", [(0.0, 1.0)]),
        ("sensor_gain", "apex_y", [(0.0, 1.0)]),
        ("sensor_gain", "force", [(-0.2121, 0.9121)]),
        ("cubic_stiffness", "leg: at apex, to the ground", [(0.0, 1.0)]),
        ("modal_damping", "all", None),
    ],
)
def test_place_of_an_effect_is_marked(study_config, effect, location, marked):
    found = FoundEffect(id=effect, location=location, parameters={})
    sheet = place_figure(study_config, with_points(["apex_y", "apex_x"]), [found])
    (table,) = [table for _, curve, table in sheet.tables if curve == f"{effect} at {location}"]
    spots = np.transpose([table["x_m"], table["z_m"]])
    if marked is None:  # all of the tube
        assert len(spots) > 100
    else:
        np.testing.assert_allclose(spots, marked, atol=2.0e-4)
