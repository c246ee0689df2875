"""A user's campaign as the records of a completion: what its checks leave usable, one force, whole
periods or the last stretch of a long record.
"""

import numpy as np

from vibroimpact.campaign.checks.file_checks import check_file, usable_signals
from vibroimpact.campaign.file import PARALLEL, SAME_POINT_M, valid_count
from vibroimpact.campaign.force_kinds import BASE, base_channels
from vibroimpact.campaign.signals import campaign_signals, common_period, transfer_band

from .long_records import mean_coherences, quick_length

OTHER_FORCE = 0.01  # of the first force: another one above it can not be left out
# of the end and of the beginning of the excited band that are kept of a record without period, the
# longer of them
CYCLES = 1000
LOW_CYCLES = 60
COHERENT = 0.7  # mean coherence below which a record without period earns a warning
# times the usual difference to the last period, and of the response: a leading period with more
# holds the transient
SETTLED = 2.0
UNSEEN = 0.005
# Kinds of channels that are left out, and why.
NO_MOTION = {
    "contact_force": "a contact force is no motion",
    "strain": "measured modes do not tell how a strain follows from motions",
}


class Unusable(ValueError):
    """A campaign that no completion can be made of; the message is a sentence with the remedy."""


def own_records(path):
    """Return (campaign Dataset with what is usable, rows of checks, measured signals) of a campaign
    file of any state.

    Channels that are unusable in some record, contact forces, strains, and records without a usable
    force are left out. Attributes of the Dataset: period_samples (0: each record has a period of
    its own, or whole_records says that they have none and are cut to their last stretch),
    transient_periods.
    Raises Unusable, also where the base moved; its argument `rows` are the checks.
    """
    campaign, rows = check_file(path)
    refusals = [row["message"] for row in rows if row["level"] == "refuse"]
    if refusals:
        raise Unusable(" ".join(refusals), rows)
    if base_channels(campaign).any():
        channel = int(np.argmax(base_channels(campaign)))
        message = (
            f"force_channel_kind[{channel}] = '{BASE}': a structure without a model is scaled by"
            " the response at a measured force, which a moving base has not: give a model of the"
            " structure, or measure a force."
        )
        raise Unusable(message, [*rows, _row("content", "refuse", message)])
    force, response = usable_signals(campaign, rows)
    kinds = [str(kind) for kind in campaign["channel_kind"].values]
    force &= response.any(axis=1)
    shown = response[force].all(axis=0) & ~np.isin(kinds, list(NO_MOTION))
    for channel in np.flatnonzero(~shown):
        why = NO_MOTION.get(kinds[channel], "it can not be used in every record")
        name = str(campaign["channel_name"].values[channel])
        rows.append(_row("channels", "warn", f"{name} is left out of the completion: {why}.", name))
    if not shown.any():
        raise Unusable(
            "No channel is usable in every record: repair or leave out the records that the checks"
            " name.",
            rows,
        )
    force &= _one_gap(campaign, force, rows)
    kept = campaign.isel(record=np.flatnonzero(force), channel=np.flatnonzero(shown))
    measured = campaign_signals(kept)
    _one_force(measured, rows)
    periods = [measured.period_samples or common_period([signals[0]]) for signals in measured.force]
    if all(periods):
        transient = max(
            int(kept.attrs.get("transient_periods", 0)),
            *map(unsettled_periods, measured.response, periods),
        )
        return (
            kept.assign_attrs(period_samples=measured.period_samples, transient_periods=transient),
            rows,
            measured,
        )
    band = transfer_band(measured)
    if band is None:
        raise Unusable("The records are too short to tell which lines the force excites.", rows)
    _coherent(measured, band, rows)
    return (
        _last_stretch(
            kept, int(max(CYCLES / band[1], LOW_CYCLES / band[0]) * measured.rate)
        ).assign_attrs(period_samples=0, transient_periods=0, whole_records=1),
        rows,
        measured,
    )


def _row(check, level, message, channel=None):
    return {"check": check, "level": level, "record": None, "channel": channel, "message": message}


def _one_force(measured, rows):
    """Raise Unusable where a second force drives the structure as well."""
    for signals in measured.force:
        sizes = np.sqrt(np.mean(np.square(np.nan_to_num(signals)), axis=-1))
        if sizes.size > 1 and sizes[1:].max() > OTHER_FORCE * sizes[0]:
            raise Unusable(
                f"Several forces act at once ({', '.join(measured.forces)}): modes are identified"
                " under one; drive at one point.",
                rows,
            )


def _one_gap(campaign, usable, rows):
    """Return (record,) whether a record has the gap that most usable ones have: another gap is
    another structure.
    """
    gap = np.nan_to_num(campaign["gap"].values.astype(float), nan=-1.0)
    values, counts = np.unique(gap[usable], return_counts=True)
    chosen = values[int(np.argmax(counts))]
    if values.size > 1:
        told = "without gap" if chosen < 0.0 else f"with the gap {chosen:.4g} m"
        rows.append(
            _row(
                "gaps",
                "warn",
                f"The records have {values.size} gaps, each another structure: only those {told}"
                " are used.",
            )
        )
    return gap == chosen


def _coherent(measured, band_Hz, rows):
    """Add a row per record and channel: the mean coherence with the force, which noise and what is
    not linear lower.
    """
    for name, force, response in zip(
        measured.records, measured.force, measured.response, strict=True
    ):
        for channel, value in zip(
            measured.channels,
            mean_coherences(force[0], response, measured.rate, band_Hz),
            strict=True,
        ):
            row = _row(
                "coherence",
                "warn" if value < COHERENT else "pass",
                f"The mean coherence of {channel} with the force is {value:.2f} in record {name}.",
                channel,
            )
            rows.append({**row, "record": name})


def unsettled_periods(response, period):
    """Return how many leading periods of a response (channel, time) differ from the last one by
    more than the rest do; one is always kept.
    """
    count = response.shape[-1] // period
    if count < 3:
        return max(count - 1, 0)
    parts = response[:, response.shape[-1] - count * period :].reshape(len(response), count, period)
    size = np.maximum(parts[:, -1].std(axis=-1), np.finfo(float).tiny)
    apart = np.sqrt(
        np.mean(((parts[:, :-1] - parts[:, -1:]).std(axis=-1) / size[:, None]) ** 2, axis=0)
    )
    usual = np.sort(apart)[
        (apart.size - 1) // 2
    ]  # drift makes near periods more alike than far ones: not the least
    settled = apart <= max(SETTLED * usual, UNSEEN)
    return int(np.argmax(settled))


def _last_stretch(campaign, longest):
    """The campaign with the last samples of every record moved to the front, at most `longest` of
    each.
    """
    counts = np.array([valid_count(campaign, record) for record in range(campaign.sizes["record"])])
    kept = np.array([quick_length(min(count, longest)) for count in counts])
    out = campaign.isel(time=slice(0, int(kept.max()))).copy(deep=True)
    for record, (count, size) in enumerate(zip(counts, kept, strict=True)):
        for name in ("force", "response"):
            out[name].values[record] = np.nan
            out[name].values[record, :, :size] = campaign[name].values[
                record, :, count - size : count
            ]
    return out.drop_vars("voltage", errors="ignore").assign(valid_samples=("record", kept))


def drive_channel(campaign, measured, wanted=None):
    """Return (index of the channel at the force, sentence or None where it is not at its point,
    sign that turns it along the force).

    wanted: its name; else the nearest channel along the force, or the nearest of all. The sentence
    says how far it is.
    """
    names = [str(name) for name in campaign["channel_name"].values]
    force = measured.force_directions[0] / max(
        np.linalg.norm(measured.force_directions[0]), np.finfo(float).tiny
    )
    along = measured.directions @ force
    distance = np.linalg.norm(
        measured.points - campaign["force_channel_point"].values[0].astype(float), axis=1
    )
    distance = np.where(np.isfinite(distance), distance, np.inf)
    if wanted is not None:
        index = names.index(wanted)
    else:
        index = int(np.argmin(distance + np.where(np.abs(along) > PARALLEL, 0.0, 1.0e6)))
    here = np.abs(along[index]) > PARALLEL and distance[index] < SAME_POINT_M
    away = (
        None
        if here
        else (
            f"{names[index]} is taken for the response at the force but lies"
            f" {distance[index] * 1e3:.3g} mm away or across it: stiffnesses and forces of laws are"
            " then only right up to a factor; measure at the force."
        )
    )
    return index, away, -1.0 if along[index] < -PARALLEL else 1.0
