"""A campaign's records as levels by their lines, and which of them are fitted, tried and kept
back.
"""

from vibroimpact.campaign.signals import campaign_signals
from vibroimpact.spectra.periodic_lines import level_lines

from .long_records import long_record_lines

SETTLED = 2  # the attribute whole_records of records whose transient was taken away
SAME_LOAD = 1.05  # records within this factor repeat one level
FEWEST_FITTED = 3  # fewer fitted levels than this leave none to try a name on


def levels_of(campaign):
    """Return ([LevelLines], channel names, kinds) of a campaign in ascending load, in SI or, where
    a channel is generic, its own units.

    Records are taken as without period where the attribute whole_records says so (long_records).
    Raises multisine.PeriodError for any other record without period.
    """
    signals, levels = campaign_signals(campaign).require_units(), []
    for record, name in enumerate(signals.records):
        told = (
            name,
            signals.splits[record],
            signals.force[record][0],
            signals.response[record],
            campaign.attrs["sampling_frequency"],
        )
        if campaign.attrs.get("whole_records", 0):
            levels.append(
                long_record_lines(*told, settled=campaign.attrs["whole_records"] == SETTLED)
            )
        else:
            levels.append(
                level_lines(
                    *told,
                    int(campaign.attrs["period_samples"]),
                    int(campaign.attrs["transient_periods"]),
                )
            )
    return sorted(levels, key=lambda level: level.load_rms), signals.channels, signals.kinds


def naming_split(levels):
    """Return (fitted, tried): the levels that candidates are fitted to, and those that their names
    are tried on.

    The fitted level below the highest one is set aside for the name, with all records of its load,
    and is fitted once the name stands, so that held-out levels choose nothing. Where only two
    levels are fitted, the held-out ones are tried. Raises ValueError when there are too few.
    """
    fitted = [level for level in levels if level.split == "fit"]
    held = [level for level in levels if level.split != "fit"]
    if len(fitted) < 2:
        raise ValueError(
            f"{len(fitted)} levels are to be fitted: two are the least, of different load"
        )
    loads = _distinct([level.load_rms for level in fitted])
    if len(loads) < FEWEST_FITTED:
        if held:
            return fitted, held
        raise ValueError(
            "two levels to fit and none held out: a name could only be tried on what it was fitted"
            " to; record a third level"
        )
    tried = [level for level in fitted if loads[-2] <= level.load_rms < loads[-1]]
    return [level for level in fitted if level not in tried], tried


def _distinct(loads):
    """The lowest load of each group of ascending loads that lie within SAME_LOAD of it."""
    found = []
    for load in loads:
        if not found or load > SAME_LOAD * found[-1]:
            found.append(load)
    return found
