"""The first step of a user's completion: usable records, the study, linear models level by level,
places ranked, and whether a law can be tried.
"""

from dataclasses import asdict, replace

import numpy as np

from vibroimpact.campaign.file import valid_count
from vibroimpact.campaign.signals import transfer_band
from vibroimpact.identify.modal_fit import identify_modes
from vibroimpact.records import plain_values
from vibroimpact.spectra.periodic_lines import line_power

from .levels import SETTLED, levels_of, naming_split
from .linear_models import linear_errors, linear_models
from .long_records import settled_response
from .mounting import mounting_table
from .own_records import Unusable, drive_channel, own_records
from .own_study import LAWS_TRIED, SECOND_LAWS, check_names, default_band, own_study
from .places import ranked_places, tried_places
from .store import modes_of

MISSED = 0.5  # of the response of the lowest level: a linear model that misses more is none
SIMPLE = 1.15  # times the least error: a model with fewer residual modes within it is taken
SCATTERED = 0.2  # of the mean response: scatter between periods above it leaves a record out
AROUND = 0.4  # of the frequency of the mode that changes: where its peak is looked for


def prepared(name, path, asked, told=print):
    """Return (values, campaign, linear, mounting rows) of a user's campaign file and StructureFile.

    values: {study or None, checks, refused: sentence or None, places: ranking}; campaign: Dataset
    of what is usable, None where nothing is; linear: values of linear_models, {} where there is
    none. Raises ConfigError for channels that the file names and the campaign lacks.
    """
    try:
        usable, rows, measured = own_records(path)
    except Unusable as error:
        return (
            {"study": None, "checks": error.args[1], "refused": error.args[0], "places": []},
            None,
            {},
            [],
        )
    names = [str(each) for each in usable["channel_name"].values]
    check_names(asked, names)
    drive, away, sign = drive_channel(usable, measured, asked.drive)
    if away:
        rows.append(
            {
                "check": "drive",
                "level": "warn",
                "record": None,
                "channel": names[drive],
                "message": away,
            }
        )
    if sign < 0.0:  # shapes are scaled by the drive, whose response must count along the force
        usable = usable.copy(deep=True)
        usable["response"].values[:, drive] *= -1.0
        usable["channel_direction"].values[drive] *= -1.0
    values = {"study": None, "checks": rows, "refused": None, "places": []}
    try:
        levels, names, kinds = levels_of(usable)
        levels = [level for level in levels if level.split == "fit"] or levels
        excited = asked.band_Hz or transfer_band(measured)
        if excited is None:
            raise ValueError("The force excites too few lines: give band_Hz.")
        study = own_study(
            name,
            asked,
            usable,
            drive,
            asked.band_Hz or default_band(levels, kinds, excited, measured.rate),
        )
        values["study"] = asdict(study)
        study = (
            study
            if asked.residual_modes
            else _with_residuals(study, levels[0], kinds, names, drive)
        )
        told(
            f"band {study.band_Hz[0]:.4g} to {study.band_Hz[1]:.4g} Hz, drive {study.drive},"
            f" residual modes {study.residual_modes}, {len(study.places)} places"
        )
        usable = _repeating(usable, study, rows)
        levels = [level for level in levels_of(usable)[0] if level.split == "fit"]
        fitted = naming_split(levels_of(usable)[0])[0]
        linear = linear_models(usable, study)
        if usable.attrs.get("whole_records", 0):
            usable = _settled(usable, study, linear)
            linear = linear_models(usable, study)
        base = modes_of(linear["base"])
        ranking = ranked_places(base, study, fitted)
    except ValueError as error:
        return {**values, "refused": _sentence(error)}, usable, {}, []
    tried = tried_places(ranking)
    told("places: " + ", ".join(f"{row['place']} {row['error']:.3g}" for row in ranking))
    candidates = study.candidates or tuple(
        f"{law}.{place}" for place in tried for law in LAWS_TRIED
    )
    additions = (
        study.additions
        if asked.additions is not None
        else tuple(f"{law}.{tried[0]}" for law in SECOND_LAWS)
    )
    study = replace(
        study,
        candidates=candidates,
        additions=additions,
        mounting=study.mounting or tried[0],
        peak_Hz=study.peak_Hz or _peak(base, linear, levels, ranking[0]["place"], study),
    )
    missed = linear_errors(base, levels[0], study.band_Hz)
    if np.median(missed) > MISSED:
        values["refused"] = (
            f"The linear model of {levels[0].name} misses {np.median(missed):.0%} of the response:"
            " what it lacks can not be told from what a law would add. A lower level, a narrower"
            " band_Hz, or a channel at the force may help."
        )
    try:
        mounting = mounting_table(levels_of(usable)[0], study, linear)[0]
    except ValueError as error:
        told(f"no equivalent support by level: {error}")
        mounting = []
    return (
        plain_values({**values, "study": asdict(study), "places": ranking}),
        usable,
        linear,
        mounting,
    )


def _repeating(campaign, study, rows):
    """The campaign without records whose response does not repeat with the force: chaotic, drifting
    or drowned, no law can be told by their waveform.
    """
    lost = set()
    for level in levels_of(campaign)[0]:
        lines = level.excited(study.band_Hz)
        share = np.sqrt(
            line_power(level.noise, level.frequency, lines)
            / line_power(level.response, level.frequency, lines)
        )
        if level.periods > 1 and np.median(share) > SCATTERED:
            lost.add(level.name)
            rows.append(
                {
                    "check": "periods",
                    "level": "warn",
                    "record": level.name,
                    "channel": None,
                    "message": (
                        "The response does not repeat with the force: its mean over periods is"
                        f" uncertain by {np.median(share):.0%}. The record is left out: no waveform"
                        " can be fitted to it."
                    ),
                }
            )
    return campaign.isel(
        record=[
            index
            for index, name in enumerate(campaign["record_name"].values)
            if str(name) not in lost
        ]
    )


def _settled(campaign, study, linear):
    """The records without period with the free decay of every level's own modes taken away."""
    out = campaign.copy(deep=True).assign_attrs(whole_records=SETTLED)
    for record, name in enumerate(campaign["record_name"].values):
        count = valid_count(campaign, record)
        force, response = (
            campaign[key].values[record, :, :count].astype(float) for key in ("force", "response")
        )
        out["response"].values[record, :, :count] = settled_response(
            force[0],
            response,
            campaign.attrs["sampling_frequency"],
            modes_of(plain_values(linear["refitted"][str(name)])),
            study.band_Hz,
        )
    return out


def _sentence(error):
    text = str(error)
    return text[0].upper() + text[1:].rstrip(".") + "."


def _with_residuals(study, level, kinds, names, drive):
    """The study with the fewest residual modes that miss hardly more of the lowest level than the
    best choice does.
    """
    found = []
    for residuals in ((False, False), (True, False), (False, True), (True, True)):
        try:
            modes = identify_modes(level, study.band_Hz, kinds, names, drive, residuals)[0]
        except ValueError as error:
            problem = error
            continue
        found.append(
            (residuals, float(np.sqrt(np.mean(linear_errors(modes, level, study.band_Hz) ** 2))))
        )
    if not found:
        raise problem
    least = min(error for _, error in found)
    return replace(
        study,
        residual_modes=next(residuals for residuals, error in found if error <= SIMPLE * least),
    )


def _peak(base, linear, levels, place, study):
    """(low, high) Hz round the mode with most of the error of the linear model, of those that move
    at a place.
    """
    row = np.array([study.places[place].get(name, 0.0) for name in base.names])
    level = levels[-1]
    lines = np.flatnonzero(level.excited(study.band_Hz))
    frequency = level.frequency[lines]
    size = np.linalg.norm(level.response[:, lines], axis=1, keepdims=True)
    missed = np.sum(
        np.abs((base.frf(frequency) * level.force[lines] - level.response[:, lines]) / size) ** 2,
        axis=0,
    )
    moving = np.flatnonzero(~base.residual & (np.abs(base.shapes @ row) > 0.0))
    shares = [
        missed[np.abs(frequency - base.frequency[mode]) < 0.5 * AROUND * base.frequency[mode]].sum()
        for mode in moving
    ]
    centre = base.frequency[moving[int(np.argmax(shares))]]
    return float((1.0 - AROUND) * centre), float((1.0 + AROUND) * centre)
