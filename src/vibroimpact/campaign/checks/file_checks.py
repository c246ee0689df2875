"""All checks of a campaign file: rows {check, level, record, channel, message}.

level is "pass"; "warn", if a signal or record is left out or to be read with care; "refuse",
if no verdict is possible; or "not checked", with the reason. record and channel are names, None
if a row is about all of them.
A file is refused only if the rest holds no measured force, no response, or no two levels.
"""

from pathlib import Path

import numpy as np
import xarray as xr

from vibroimpact.campaign.base_motion import base_motion_rows, relative_to_base
from vibroimpact.campaign.contract import NO_FORCE, contract_problems
from vibroimpact.campaign.file import (
    LARGEST,
    CampaignError,
    decode_texts,
    fill_missing,
    opened_campaign,
    with_no_force,
)
from vibroimpact.campaign.signals import (
    SEGMENT_S,
    blows,
    campaign_signals,
    common_period,
    transfer_or_reason,
)
from vibroimpact.io.records import RecordError

from . import linear_record, signal_faults, stated
from .between_records import contradictions, copies, spike
from .stated import check_row, warning

NOT_CHECKED = "not checked"
BESIDE = {"base motion": "load_rms"}  # a check of some campaigns alone, and the one that it follows
# A warning of these excludes its signal from every comparison.
EXCLUDING_CHECKS = ("units", "gaps in time", "spikes", "clipping", "drop-outs", "record length")
LEVELS_APART = 1.05
BANDS_PER_DECADE = 24 / np.log10(200.0 / 5.0)
NOT_IMPORTED = " A campaign is netCDF: snakemake import_campaign makes one of UFF, MATLAB or CSV."
SEVERAL = "with several forces, each may drive motion that does not follow the first"
FEWEST_PERIODS, GOOD_AVERAGES = 10.0, 6.0


def check_file(path: str | Path) -> tuple[xr.Dataset | None, list[dict]]:
    """Return (campaign Dataset or None, rows of all checks) of a campaign file of any state.

    A file that can not be read gives a single row, which refuses it.
    """
    try:
        campaign = opened_campaign(path)
    except RecordError as error:
        reason = str(error).removeprefix(f"{path}: ")
        remedy = "" if Path(path).suffix == ".nc" else NOT_IMPORTED
        return None, [check_row("contract", "refuse", f"The file {reason}.{remedy}")]
    rows = check_campaign(campaign)
    if any(row["check"] == "contract" and row["level"] == "refuse" for row in rows):
        return None, rows
    try:
        return fill_missing(with_no_force(campaign)), rows
    except CampaignError:  # a row refuses the unit of the force
        return None, rows


def check_campaign(campaign: xr.Dataset) -> list[dict]:
    """Return the rows of all checks of a campaign Dataset, in the order of CHECKS.

    A check without complaint gives one row of level "pass". One that could not be made gives a row
    "not checked" with the reason. Faults of single signals are sought in the recorded ones; all
    that follows looks at the motion relative to the base.
    """
    campaign = decode_texts(campaign)
    given = with_no_force(campaign)
    problems = [*contract_problems(given, force_needed=given is campaign)]
    if not problems and given is not campaign:
        return _without_force(given)
    if problems:
        return [check_row("contract", "refuse", f"{problem}.") for problem in problems]
    try:
        campaign = fill_missing(campaign)
    except CampaignError as error:  # the load can not be computed from a force of unknown unit
        return [check_row("units", "refuse", f"The {error}.")]
    measured = campaign_signals(campaign)
    rows = [
        *stated.assumed_rows(campaign),
        *stated.unit_rows(measured),
        *stated.size_rows(campaign, measured),
        *stated.time_rows(campaign, measured),
        *stated.period_rows(measured),
        *_signal_faults(measured),
        *stated.short_rows(measured),
    ]
    usable = usable_signals(campaign, rows)
    rows += base_motion_rows(measured)
    measured = relative_to_base(measured)
    record = measured.lowest()
    without = "no record has a force and a response without holes"
    spectra = without if record is None else transfer_or_reason(measured, record)
    rows += [
        *stated.load_rows(campaign, measured),
        *_linear(measured, spectra, record),
        *_between_records(measured),
        *_directions(measured),
        *_stationarity(measured, usable, spectra),
        *_length(measured, spectra),
        *_content(measured, usable),
    ]
    if "time" not in campaign:
        rows.append(_not_checked("time", "the file has no variable time"))
    complained = {row["check"] for row in rows}
    rows += [
        check_row(check, "pass", said) for check, said in PASSED.items() if check not in complained
    ]
    return sorted(rows, key=lambda row: CHECKS.index(BESIDE.get(row["check"], row["check"])))


def _without_force(campaign: xr.Dataset) -> list[dict]:
    """Return the rows of the checks that need no measured force."""
    measured = campaign_signals(fill_missing(campaign))
    return [
        *stated.unit_rows(measured),
        *stated.size_rows(campaign, measured),
        *stated.time_rows(campaign, measured),
        *_signal_faults(measured),
        check_row("content", "refuse", f"The campaign {NO_FORCE}."),
    ]


PASSED = {  # in the order of the rows
    "contract": "The file holds every variable of the contract.",
    "units": "Every channel has a unit of its kind.",
    "sizes": "Gaps and places are as large as those of a structure in metres.",
    "time": "Samples are even in time and agree with sampling_frequency.",
    "gaps in time": "No sample is missing.",
    "spikes": "No sample stands alone far beyond all others.",
    "clipping": "No signal has flat tops.",
    "drop-outs": "No signal is held or vanishes for a while.",
    "load_rms": "load_rms is the RMS of the first force channel.",
    "coherence": "At the lowest level the responses follow the force.",
    "delay": "No channel lags the others at the lowest level.",
    "swapped channels": "Nothing hints at swapped or reversed channels.",
    "between records": "No record contradicts the others, and none is a copy.",
    "directions": "Every channel has a place and a unit direction.",
    "stationarity": "No band level drifts within a record.",
    "record length": "Every record is long enough for the lowest band that is looked at.",
    "content": "There are a force, a response and two levels or more.",
}
CHECKS = tuple(PASSED)


def _not_checked(check: str, reason: str) -> dict:
    """Return the row of a check that could not be made."""
    return check_row(check, NOT_CHECKED, f"Not checked: {reason}.")


def refused(rows: list[dict]) -> bool:
    """Whether a row refuses the campaign."""
    return any(row["level"] == "refuse" for row in rows)


def usable_signals(campaign: xr.Dataset, rows: list[dict]) -> tuple[np.ndarray, np.ndarray]:
    """Return (force (record,), response (record, channel)), whether each can be used.

    rows: of check_campaign; warnings of EXCLUDING_CHECKS exclude a signal. force is the first
    force channel.
    """
    names = {
        key: [str(name) for name in campaign[key].values]
        for key in ("record_name", "channel_name", "force_channel_name")
    }
    force = np.ones(len(names["record_name"]), bool)
    response = np.ones((force.size, len(names["channel_name"])), bool)
    for row in rows:
        excluding = row["check"] in EXCLUDING_CHECKS and row["level"] in ("warn", "refuse")
        if not excluding or row["channel"] is None:
            continue
        which = slice(None) if row["record"] is None else names["record_name"].index(row["record"])
        if row["channel"] in names["channel_name"]:  # no name stands twice in a file
            response[which, names["channel_name"].index(row["channel"])] = False
        elif row["channel"] == names["force_channel_name"][0]:
            force[which] = False
    return force, response


def _signal_faults(measured):
    """Yield rows of faults of single signals, record by record."""
    for record, name in enumerate(measured.records):
        period = measured.period_samples or common_period(list(measured.force[record][:1]))
        forces = zip(measured.forces, measured.force[record], strict=True)
        responses = zip(measured.channels, measured.response[record], strict=True)
        for place, (channel, signal) in enumerate([*forces, *responses]):
            driving = place == 0 and measured.forces
            what = "The record is left out" if driving else "It is left out of this record"
            yield from _faults_of(signal, period, measured, name, channel, what)


def _faults_of(signal, period, measured, record, channel, what):
    """Yield rows of the faults of a signal; those that hide others alone."""

    def fault(check, message):
        return warning(check, message, record, channel)

    holes = np.flatnonzero(~np.isfinite(signal))
    if signal.size == 0 or holes.size:
        message = (
            f"{channel} misses {holes.size} of {signal.size} samples (no number, or beyond"
            f" {LARGEST:g}), the first at {holes[0] / measured.rate:.3f} s, in record {record}."
            f" {what}: repair the gap or shorten valid_samples."
            if signal.size
            else f"Record {record} has no valid sample."
        )
        yield fault("gaps in time", message)
        return
    # a support that is not touched exerts nothing, for as long as that lasts
    presses = (channel, "contact_force") in zip(measured.channels, measured.kinds, strict=True)
    if not signal.any() and not presses:
        yield fault("drop-outs", f"{channel} is zero throughout record {record}. {what}.")
        return
    at = spike(signal)
    if at is not None:
        yield fault(
            "spikes",
            f"{channel} has a single sample of {signal[at]:.4g} (SI) at {at / measured.rate:.3f} s"
            f" in record {record}, alone beyond all others: a fault of the transmission. {what}:"
            " cut it out with from_s and to_s, or record again.",
        )
        return
    # Only the last period of a periodic signal: every peak recurs in each period.
    share = signal_faults.clipped_share(signal[-period:] if 0 < period < signal.size else signal)
    if share is not None:
        yield fault(
            "clipping",
            f"{channel} has flat tops near {np.abs(signal - np.median(signal)).max():.4g} (SI) in"
            f" record {record}, {100 * share:.2g} % of the samples: the range of the amplifier was"
            f" too small. {what}.",
        )
    still = presses or (channel in measured.forces and blows(signal) > 0)
    lost = None if still else signal_faults.drop_out(signal, measured.rate, measured.starts_at_rest)
    if lost is not None:
        yield fault(
            "drop-outs",
            f"{channel} is held or vanishes at {lost[0]:.2f} s for {lost[1]:.3f} s in record"
            f" {record}. {what}.",
        )


def _linear(measured, spectra, record):
    """Yield rows of the lowest level: coherence, delays, hints of swapped or reversed channels."""
    if isinstance(spectra, str):
        for check in ("coherence", "delay", "swapped channels"):
            yield _not_checked(check, spectra)
        return
    name = measured.records[record]
    coherence = linear_record.mean_coherence(spectra)
    finite = measured.finite(record)
    best = float(coherence[finite].max())
    if best < linear_record.NO_CAUSE:
        yield check_row(
            "coherence",
            "refuse",
            f"No response follows {measured.forces[0]} in record {name} (mean coherence {best:.2f}"
            " at most): it is not the force that drove them, or clocks differ.",
            name,
        )
        for check in ("delay", "swapped channels"):
            yield _not_checked(check, f"no response follows {measured.forces[0]}")
        return
    if best < 0.8:
        yield warning(
            "coherence",
            f"The best response has a mean coherence of {best:.2f} with {measured.forces[0]} in"
            f" record {name}: the lowest level is not linear, noisy, or moved by another force as"
            " well.",
            name,
        )
    apart, common = linear_record.channel_delays(spectra, measured.kinds, measured.rate, finite)
    late = [
        (channel, f"{channel} {'lags' if lag > 0 else 'leads'} the other channels", lag)
        for channel, lag in ((measured.channels[index], lag) for index, lag in apart.items())
    ]
    if common is not None:
        force = measured.forces[0]
        late.append((force, f"All responses {'lag' if common > 0 else 'lead'} {force}", common))
    for channel, told, lag in late:
        by = f"by {abs(lag):.1f} samples ({abs(lag) / measured.rate * 1e3:.2f} ms)"
        yield warning("delay", f"{told} {by} in record {name}.", name, channel)
    if len(measured.forces) > 1:
        yield _not_checked("swapped channels", SEVERAL)
    elif len(measured.channels) == 1:
        yield _not_checked("swapped channels", "there is one response")
    else:
        yield from _mix_ups(measured, spectra, name)


def _mix_ups(measured, spectra, name):
    for index, other in linear_record.swap_hints(measured, spectra):
        along = measured.channels[index]
        silent = f"{along} lies along the force and does not follow it in record {name} while"
        if other is None and linear_record.wakes(measured, index):
            continue
        if other is None:
            why = {along: f"{silent} others do: it is dead or wrongly named."}
        else:
            across = measured.channels[other]
            swapped = f"{silent} {across}, which lies across the force, does: the two seem swapped."
            why = {along: swapped, across: swapped}
        for channel, message in why.items():
            yield warning("swapped channels", message, name, channel)
    against = linear_record.reversed_hint(measured, spectra)
    if against is not None:
        yield warning(
            "swapped channels",
            f"{measured.channels[against]} moves against all other channels below the first"
            f" resonance in record {name}: its polarity seems reversed.",
            name,
            measured.channels[against],
        )


def _between_records(measured):
    """Yield rows of records and channels that are copies, and of those that contradict others."""
    rows = [*copies(measured)]
    if len(measured.forces) > 1:
        yield _not_checked("between records", SEVERAL)
    elif len(measured.records) > 1:
        rows += contradictions(measured)
    for record, channel, sentence in rows:
        yield warning(
            "between records",
            f"{sentence} Correct the file, or leave the record out.",
            measured.records[record],
            measured.forces[0] if channel is None else measured.channels[channel],
        )


def _directions(measured):
    places = zip(measured.channels, measured.points, measured.directions, strict=True)
    for name, point, direction in places:
        length = float(np.linalg.norm(direction))
        if not abs(length - 1.0) < 0.01:
            yield warning(
                "directions",
                f"The direction of {name} has the length {length:.3g}, not 1: write a unit vector.",
                channel=name,
            )
        if not np.isfinite(point).all():
            yield warning(
                "directions",
                f"The place of {name} is not known: it can not be compared with a model.",
                channel=name,
            )
    if not np.isfinite(linear_record.alignment(measured)).any():
        force = measured.forces[0]
        yield warning("directions", f"The direction of {force} is not known.", channel=force)


def _stationarity(measured, usable, spectra):
    if isinstance(spectra, str):
        yield _not_checked("stationarity", spectra)
        return
    band, made = (spectra.frequency[0], spectra.frequency[-1]), False
    for record, name in enumerate(measured.records):
        if not usable[0][record]:
            continue
        responses = zip(
            measured.channels, measured.response[record], usable[1][record], strict=True
        )
        signals = [(measured.forces[0], measured.force[record][0], True), *responses]
        for channel, signal in ((own[0], own[1]) for own in signals if own[2]):
            trend = signal_faults.level_trend(signal, measured.rate, band, measured.starts_at_rest)
            made = made or trend is not None
            change, t = trend or (0.0, 0.0)
            if abs(t) > signal_faults.TREND_T and abs(change) > signal_faults.TREND_DB:
                yield warning(
                    "stationarity",
                    f"The level of {channel} {'rises' if change > 0 else 'falls'} by"
                    f" {abs(change):.1f} dB over record {name} (t = {t:.1f}).",
                    name,
                    channel,
                )

    if not made:
        yield _not_checked("stationarity", "no record is long enough for a trend of its level")


def _length(measured, spectra):
    if isinstance(spectra, str):
        yield _not_checked("record length", spectra)
        return
    low, high = float(spectra.frequency[0]), float(spectra.frequency[-1])
    durations = measured.valid_samples / measured.rate
    step = float(np.diff(spectra.frequency).min())
    # the lowest line falls with the length of the record if the force excites all of them
    falls = measured.stated_band is None and low < 2.5 * step
    lowest = 1.0 / SEGMENT_S if falls else low
    for name, duration in zip(measured.records, durations, strict=True):
        # from here on, a band of the comparison holds GOOD_AVERAGES independent averages
        sure = GOOD_AVERAGES / (duration * (10.0 ** (1.0 / BANDS_PER_DECADE) - 1.0))
        if sure > low:
            stated = f"[{np.ceil(100.0 * sure) / 100.0:g}, {np.floor(10.0 * high) / 10.0:g}]"
            yield warning(
                "record length",
                f"Record {name} of {duration:.3g} s is sure from {sure:.3g} Hz up. The force"
                f" excites {low:.3g} Hz and above: state band_Hz: {stated} in campaign.yaml, or"
                f" record {np.ceil(duration * sure / lowest):.0f} s.",
                name,
            )
    if durations.max() * spectra.responding < FEWEST_PERIODS:
        yield check_row(
            "record length",
            "refuse",
            f"Every record is shorter than {FEWEST_PERIODS:.0f} periods of the lowest frequency of"
            f" the response, {spectra.responding:.3g} Hz: {FEWEST_PERIODS / spectra.responding:.3g}"
            " s would do.",
        )


def _content(measured, usable):
    """Yield rows of the least that a verdict needs, after the other checks excluded signals."""
    force, response = usable
    whole = force & response.any(axis=1)
    driven = force.any() and not measured.force_unit_faults.get(0)
    if not driven or not whole.any():
        lacking = "response is usable together with a usable force: a verdict needs one response"
        if not driven:
            name = measured.forces[0]
            lacking = f"record has a usable force {name}: a verdict needs one measured force"
        yield check_row("content", "refuse", f"No {lacking}.")
        return
    loads = measured.load_rms[whole]
    if not loads.max() > LEVELS_APART * loads.min():
        told = f"All usable records have the load {loads.max():.4g}: a verdict needs two levels."
        yield check_row("content", "refuse", told)
    splits = {measured.splits[record] for record in np.flatnonzero(whole)}
    for split, why in (
        ("fit", "nothing can be fitted"),
        ("holdout", "nothing is left to verify on"),
    ):
        if split not in splits:
            yield warning("content", f"No usable record has the split '{split}': {why}.")
