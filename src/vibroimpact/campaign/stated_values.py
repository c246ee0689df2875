"""The allowed values of a campaign file: names, numbers, units and attributes that can be.

Each function yields sentences that begin with the place, "gap[0] = -0.001 m", and end with the
remedy.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import xarray as xr

from vibroimpact.identify.spectra.periodic_lines import SHORTEST_PERIOD
from vibroimpact.io.units import UnitError, si_factor

from .force_kinds import FORCE_KINDS, unit_kinds

Kind = Literal["acceleration", "velocity", "displacement", "contact_force", "strain", "generic"]
KINDS = get_args(Kind)
SPLITS = ("fit", "holdout")
START_UPS = ("rest", "stationary")
LONGEST_NAME = 200  # characters
HIGHEST_RATE_HZ = 1.0e9


@dataclass(frozen=True)
class Range:
    """The numbers that may stand in a variable.

    low, high: ends, both allowed.
    unit: of the values, "" if they have none. Another one in the attribute `units` is a problem.
    whole: only whole numbers.
    unknown: NaN stands for a value that is not known.
    remedy: the value to write; too_high: the same for a finite number that is too large.
    """

    low: float
    high: float
    unit: str
    remedy: str
    whole: bool = False
    unknown: bool = False
    too_high: str = ""


METRE = ("metre", "meter", "metres", "meters")
METRES = "is it in millimetres? Write metres"
GAP = "give the radial clearance in m, NaN if there is none"
CLEARANCE = Range(0.0, 1.0, "m", GAP, unknown=True, too_high=METRES)
KNOWN = "write metres, NaN if it is not known"
PLACE = Range(-1.0e4, 1.0e4, "m", KNOWN, unknown=True, too_high=METRES)
DIRECTION = Range(-1.0e4, 1.0e4, "", "write a unit vector", unknown=True)
RANGES = {
    "gap": CLEARANCE,
    "support_gap": CLEARANCE,
    "channel_point": PLACE,
    "force_channel_point": PLACE,
    "channel_direction": DIRECTION,
    "force_channel_direction": DIRECTION,
    "load_rms": Range(
        0.0, 1.0e12, "", "write the RMS of force channel 0, or leave load_rms out", unknown=True
    ),
    "repeat": Range(0, 10**9, "", "count records of the same load and gap from 0", whole=True),
    "time": Range(-1.0e12, 1.0e12, "", "write the seconds since the start of the record"),
    "noise_floor_rms": Range(0.0, 1.0e12, "", "write the RMS of the channel's noise in its unit"),
}


def stated_value_problems(campaign: xr.Dataset, sound: set[str]) -> Iterator[str]:
    """Yield a sentence for every value that can not be, of the variables `sound` in form."""
    yield from _attribute_problems(campaign)
    for name, allowed in RANGES.items():
        if name in sound:
            unit, stated = allowed.unit, campaign[name].attrs.get("units", "")
            if unit and str(stated).strip() not in ("", unit, *METRE):
                yield (
                    f"'{name}' has the attribute units = '{stated}': write its values and units in"
                    f" {unit}"
                )
            yield from _range_problem(name, campaign[name].values, allowed)
    if "valid_samples" in sound:
        samples = campaign.sizes["time"]
        remedy = f"count the valid samples of the record from its start, 1 to {samples}"
        allowed = Range(1, samples, "", remedy, whole=True, unknown=True)
        yield from _range_problem("valid_samples", campaign["valid_samples"].values, allowed)
    yield from _name_problems(campaign, sound)
    if "force" in sound and "force_channel_units" not in campaign:
        try:
            for kind in unit_kinds(campaign):
                si_factor(str(campaign["force"].attrs.get("units", "N")), kind)
        except UnitError as error:
            yield f"'force' {error}"
    for name, known in (
        ("channel_kind", KINDS),
        ("force_channel_kind", FORCE_KINDS),
        ("split", SPLITS),
    ):
        if name in sound:
            for text in sorted({str(value) for value in campaign[name].values} - set(known)):
                yield f"{name} '{text}' is unknown: use one of {', '.join(known)}"


def _range_problem(name: str, values: np.ndarray, allowed: Range) -> Iterator[str]:
    """Yield a sentence about the first value out of range: which, how many more, the remedy."""
    numbers = values.astype(float)
    known = np.isnan(numbers) if allowed.unknown else np.zeros(numbers.shape, bool)
    inside = (numbers >= allowed.low) & (numbers <= allowed.high)
    if allowed.whole:
        inside &= numbers == np.floor(numbers)
    wrong = np.argwhere(~(inside | known))
    if not wrong.size:
        return
    place = tuple(int(index) for index in wrong[0])
    value = float(numbers[place])
    unit = f" {allowed.unit}" if allowed.unit else ""
    if np.isnan(value):
        what = "is no number"
    elif value < allowed.low:
        what = "is negative" if allowed.low == 0 else f"is below {allowed.low:g}"
    elif value > allowed.high:
        what = f"is more than {allowed.high:g}{unit}"
    else:
        what = "is no whole number"
    finite_and_high = np.isfinite(value) and abs(value) > allowed.high
    remedy = allowed.too_high if allowed.too_high and finite_and_high else allowed.remedy
    more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
    index = "".join(f"[{number}]" for number in place)
    yield f"{name}{index} = {value:g}{unit} {what}{more}: {remedy}"


def _name_problems(campaign: xr.Dataset, sound: set[str]) -> Iterator[str]:
    """Yield a sentence for every name that is empty or stands twice.

    The responses and forces of a record share one list of names.
    """
    for group in (("record_name",), ("channel_name", "force_channel_name")):
        seen: dict[str, str] = {}
        for variable in group:
            for index, value in enumerate(campaign[variable].values if variable in sound else ()):
                name, place = str(value), f"{variable}[{index}]"
                if not name or len(name) > LONGEST_NAME or not name.isprintable():
                    yield (
                        f"{place} = {name[:60]!r} can not be shown: give a name of 1 to"
                        f" {LONGEST_NAME} printable characters"
                    )
                elif name in seen:
                    yield (
                        f"{place} = '{name}' is the name of {seen[name]} too: give each a name of"
                        " its own"
                    )
                seen.setdefault(name, place)


def _attribute_problems(campaign: xr.Dataset) -> Iterator[str]:
    """Yield a sentence for every global attribute that can not be used."""
    samples, attributes = campaign.sizes.get("time", 0), campaign.attrs
    rate = number_of(attributes.get("sampling_frequency", np.nan))

    def wrong(name: str, told: str) -> str:
        return f"{name} = {_shown(attributes[name])} {told}"

    if "sampling_frequency" not in attributes:
        yield "has no attribute sampling_frequency: give it in Hz"
    elif not 0.0 < rate <= HIGHEST_RATE_HZ:
        told = "is no sampling frequency: write samples per second, in Hz, as a number"
        yield wrong("sampling_frequency", told)
    period = number_of(attributes.get("period_samples", 0))
    if period != 0.0 and not (SHORTEST_PERIOD <= period <= samples and period.is_integer()):
        yield wrong(
            "period_samples",
            f"is no period: write the samples of a period of the force, {SHORTEST_PERIOD} to"
            f" {samples}, or 0 if it does not repeat",
        )
    if "band_Hz" in attributes:
        band = attributes["band_Hz"]
        pair = not isinstance(band, str) and np.shape(band) == (2,)
        low, high = map(number_of, band if pair else (np.nan, np.nan))
        if not 0.0 <= low < high or high > 0.5 * rate:
            yield wrong(
                "band_Hz",
                "is no band: write the lowest and the highest frequency in Hz, up to half the"
                f" sampling frequency, {0.5 * rate:g} Hz",
            )
    transient = number_of(attributes.get("transient_periods", 0))
    if not (0.0 <= transient <= 1.0e6 and transient.is_integer()):
        told = "is no number of periods: write how many pass before the steady state, from 0"
        yield wrong("transient_periods", told)
    start_up = attributes.get("start_up", START_UPS[0])
    if not (isinstance(start_up, str) and start_up in START_UPS):
        yield wrong("start_up", f"is unknown: use one of {', '.join(START_UPS)}")
    if not isinstance(attributes.get("antialias", ""), str):
        yield wrong("antialias", "is no text: write fir80 or none, or the filter of the recorder")


def number_of(value: Any) -> float:
    """Return a real number of an attribute as float; NaN for anything else."""
    if isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool):
        return float(value)
    return float("nan")


def _shown(value: Any) -> str:
    """Return a value as a sentence quotes it, at most 60 characters."""
    text = repr(value.item() if isinstance(value, np.generic) else value)
    return text if len(text) <= 60 else text[:57] + "..."
