"""A campaign of periodic records as levels by their lines, and which of them are fitted, tried and kept back."""

from vibroimpact.campaign import channel_factor, force_signal, valid_count
from vibroimpact.multisine import level_lines

FEWEST_FITTED = 3  # fewer fitted levels than this leave none to try a name on


def levels_of(campaign):
    """Return ([LevelLines], channel names, kinds) of a campaign in ascending load, in SI or, where a channel is generic, its own units.

    Raises multisine.PeriodError for a record without period.
    """
    names, kinds = ([str(value) for value in campaign[f"channel_{key}"].values] for key in ("name", "kind"))
    factors = [channel_factor(campaign, channel) for channel in range(len(names))]
    levels = []
    for record in range(campaign.sizes["record"]):
        count = valid_count(campaign, record)
        response = campaign["response"].values[record, :, :count].astype(float) * [[factor] for factor in factors]
        levels.append(level_lines(str(campaign["record_name"].values[record]), str(campaign["split"].values[record]), force_signal(campaign, record)[:count],
                                  response, campaign.attrs["sampling_frequency"], int(campaign.attrs["period_samples"]),
                                  int(campaign.attrs["transient_periods"])))  # fmt: skip
    return sorted(levels, key=lambda level: level.load_rms), names, kinds


def naming_split(levels):
    """Return (fitted, tried): the levels that candidates are fitted to, and those that their names are tried on.

    Held-out levels are tried where there are any. Otherwise the fitted level below the highest one is set aside for the name, and is fitted
    once the name stands. Raises ValueError when there are too few.
    """
    fitted = [level for level in levels if level.split == "fit"]
    held = [level for level in levels if level.split != "fit"]
    if len(fitted) < 2:
        raise ValueError(f"{len(fitted)} levels are to be fitted: two are the least, of different load")
    if held:
        return fitted, held
    if len(fitted) < FEWEST_FITTED:
        raise ValueError("two levels to fit and none held out: a name could only be tried on what it was fitted to; record a third level")
    return fitted[:-2] + fitted[-1:], [fitted[-2]]
