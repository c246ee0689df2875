"""The statements on a structure without a model, and defaults from its records."""

import re
from collections.abc import Sequence
from itertools import combinations

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import PARALLEL, force_units
from vibroimpact.config.measured_structure import ELSEWHERE, MeasuredStructure
from vibroimpact.config.reading import ConfigError
from vibroimpact.identify.spectra.periodic_lines import LevelLines
from vibroimpact.io.units import TIME_DERIVATIVES, si_unit

from .local_laws import LAWS

LAWS_TRIED = [law for law in LAWS if law not in ("saturation_damping", "few_frictions")]
SECOND_LAWS = ("quadratic_stiffness", "cubic_stiffness", "quadratic_drag", "single_friction")
MOST_PLACES = 60  # that are ranked
# Share of the velocity's power below the end of the band, and how much wider the band is.
ENOUGH, WIDER = 0.999, 1.3
SHARPEST = 0.4  # of the sampling frequency: the end of any band


def check_names(stated: MeasuredStructure, campaign: xr.Dataset) -> None:
    """Raise ConfigError for names that are not channels of the campaign, and places that are not
    given.
    """
    names = [str(name) for name in campaign["channel_name"].values]
    places = places_of(stated, campaign)
    channels = [] if stated.drive is None else [(f"drive = '{stated.drive}'", stated.drive)]
    channels += [(f"places.{place}.{name}", name) for place, row in places.items() for name in row]
    problems = [
        f"structure.{key} is no channel of the campaign: the usable channels are {', '.join(names)}"
        for key, name in channels
        if name not in names
    ]
    problems += [
        f"structure.{key}: '{name}' is at no place: the places are {', '.join(places)}"
        for key, others in (("candidates", ()), ("additions", (ELSEWHERE,)))
        for name in getattr(stated, key) or ()
        if name.partition(".")[2] not in (*places, *others)
    ]
    if problems:
        raise ConfigError(problems)


def check_mean(stated: MeasuredStructure, campaign: xr.Dataset, drive: int) -> None:
    """Raise ConfigError if the mean is to be compared and the channel at the force (its index) is a
    velocity or an acceleration.

    Offsets of levels follow from the static response at the force, and these have none: their mean
    is the zero of the sensor. It is not just left out: users state it to find an even law by its
    shift of the mean, and a verdict without it would look as if that had been done.
    """
    name, kind = (str(campaign[f"channel_{key}"].values[drive]) for key in ("name", "kind"))
    if stated.mean and TIME_DERIVATIVES.get(kind, 0) > 0:
        raise ConfigError(
            [
                f"structure.mean = true needs a displacement at the force, and the kind of '{name}'"
                f" is '{kind}', whose mean tells of no offset: leave mean out, or give a"
                " displacement at the force as structure.drive"
            ]
        )


def places_of(
    stated: MeasuredStructure, campaign: xr.Dataset, turned: str | None = None
) -> dict[str, dict[str, float]]:
    """Return {place: {channel: coefficient}} as stated, by default those of default_places.

    turned: the channel of the campaign with its sign reversed, None for none. Coefficients are
    stated for channels as they were recorded, so that those of this one change sign.
    """
    if stated.places is None:
        names = [str(name) for name in campaign["channel_name"].values]
        return default_places(names, campaign["channel_direction"].values.astype(float))
    return {
        place: {name: -weight if name == turned else weight for name, weight in row.items()}
        for place, row in stated.places.items()
    }


def laws_of(
    stated: MeasuredStructure, tried: Sequence[str]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return (candidates, additions), "law.place" each: as stated, by default at the places that
    are tried, the best one first, and at the best one.
    """
    candidates = stated.candidates or tuple(f"{law}.{at}" for at in tried for law in LAWS_TRIED)
    if stated.additions is not None:
        return candidates, stated.additions
    return candidates, tuple(f"{law}.{tried[0]}" for law in SECOND_LAWS)


def default_places(names: Sequence[str], directions: np.ndarray) -> dict[str, dict[str, float]]:
    """Return {place: {channel: coefficient}}: every pair of channels along one direction, then
    every channel to the ground.
    """
    slugs: list[str] = []
    for name in names:  # made unique, since they name places
        slug = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "channel"
        slug = slug if slug[0].isalpha() else f"c{slug}"
        slugs.append(slug if slug not in slugs else f"{slug}_{len(slugs)}")
    places = {}
    for first, second in combinations(range(len(names)), 2):
        along = float(np.dot(directions[first], directions[second]))
        if abs(along) > PARALLEL:
            row = {names[first]: -float(np.sign(along)), names[second]: 1.0}
            places[f"{slugs[first]}-{slugs[second]}"] = row
    places |= {slug: {name: 1.0} for slug, name in zip(slugs, names, strict=True)}
    return dict([*places.items()][:MOST_PLACES])


def default_band(
    level: LevelLines, kinds: Sequence[str], excited_Hz: Sequence[float], rate: float
) -> tuple[float, float]:
    """Return (low, high) Hz: the excited lines, up to the frequency above which next to nothing is
    left of the responses' velocity at a level.
    """
    end = min(excited_Hz[1], SHARPEST * rate)
    inside = (level.frequency >= excited_Hz[0]) & (level.frequency <= end)
    frequency = level.frequency[inside]
    orders = np.array([1.0 - TIME_DERIVATIVES.get(kind, 0) for kind in kinds])[:, None]
    power = np.abs(level.response[:, inside] * (2.0 * np.pi * frequency) ** orders) ** 2
    total = np.maximum(power.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    last = max(int(np.searchsorted(row, ENOUGH)) for row in np.cumsum(power, axis=1) / total)
    high = min(WIDER * frequency[min(last, frequency.size - 1)], frequency[-1])
    return float(frequency[0]), float(high)


def own_units(campaign: xr.Dataset, drive: int) -> dict[str, str]:
    """Return {unit of a mechanical law: unit here} from those of force and response in SI; empty if
    the response is a motion.
    """
    kind, units = (str(campaign[f"channel_{key}"].values[drive]) for key in ("kind", "units"))
    if kind != "generic":
        return {}
    force, moved = si_unit(force_units(campaign, 0), "excitation"), si_unit(units, kind)
    own = {"N": force, "m": f"({moved})"}
    units_of = {
        unit: "".join(own.get(letter, letter) for letter in unit)
        for unit in ("N/m", "N/m2", "N/m3", "N s/m", "m/s", "N s2/m2")
    }
    if force == moved:  # powers of one unit
        units_of |= {"N/m": "1", "N/m2": f"{force}-1", "N/m3": f"{force}-2", "N s/m": "s"}
        units_of |= {"m/s": f"{force} s-1", "N s2/m2": f"s2 {force}-1"}
    return units_of | {"N": force, "m": moved}
