"""The Study of a user's campaign: what the file states, and for the rest what the records say."""

import re
from itertools import combinations

import numpy as np

from vibroimpact.campaign.file import PARALLEL, force_units
from vibroimpact.config.measured_structure import ELSEWHERE
from vibroimpact.config.reading import ConfigError
from vibroimpact.units import TIME_DERIVATIVES, si_unit

from .study import Study

LAWS_TRIED = (
    "cubic_stiffness",
    "quadratic_stiffness",
    "quadratic_drag",
    "saturation_stiffness",
    "clearance",
    "single_friction",
    "coulomb_friction",
)
SECOND_LAWS = ("quadratic_stiffness", "cubic_stiffness", "quadratic_drag", "single_friction")
MOST_PLACES = 60  # that are ranked
ENOUGH, WIDER = (
    0.999,
    1.3,
)  # share of the velocity's power below the end of the band, and how much wider the band is
SHARPEST = 0.4  # of the sampling frequency: the end of any band


def check_names(asked, names):
    """Raise ConfigError for channels of a StructureFile that are not among the usable ones `names`,
    or places of candidates that are not given.
    """
    problems = []
    known = f"the usable channels are {', '.join(names)}"
    if asked.drive is not None and asked.drive not in names:
        problems.append(f"structure.drive = '{asked.drive}' is no channel of the campaign: {known}")
    for place, weights in (asked.places or {}).items():
        problems += [
            f"structure.places.{place}.{name} is no channel of the campaign: {known}"
            for name in weights
            if name not in names
        ]
    places = [
        *(asked.places or default_places(names, np.tile([1.0, 0.0, 0.0], (len(names), 1)))),
        ELSEWHERE,
    ]
    for key in ("candidates", "additions"):
        for name in getattr(asked, key) or ():
            place = name.partition(".")[2]
            if place not in places or (key == "candidates" and place == ELSEWHERE):
                problems.append(
                    f"structure.{key}: '{name}' is at no place: the places are"
                    f" {', '.join(places[:-1])}"
                )
    if asked.mounting is not None and asked.mounting not in places[:-1]:
        problems.append(
            f"structure.mounting = '{asked.mounting}' is no place: the places are"
            f" {', '.join(places[:-1])}"
        )
    if problems:
        raise ConfigError([f"{asked.source}: {problem}" for problem in problems])


def default_places(names, directions):
    """Return {place: {channel: coefficient}}: every pair of channels along one direction, then
    every channel to the ground.
    """
    slugs = _slugs(names)
    places = {}
    for first, second in combinations(range(len(names)), 2):
        along = float(np.dot(directions[first], directions[second]))
        if abs(along) > PARALLEL:
            places[f"{slugs[first]}-{slugs[second]}"] = {
                names[first]: -float(np.sign(along)),
                names[second]: 1.0,
            }
    places |= {slug: {name: 1.0} for slug, name in zip(slugs, names, strict=True)}
    return dict([*places.items()][:MOST_PLACES])


def _slugs(names):
    """Names that may be parts of file names, each its own."""
    slugs = []
    for name in names:
        slug = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "channel"
        slug = slug if slug[0].isalpha() else f"c{slug}"
        slugs.append(slug if slug not in slugs else f"{slug}_{len(slugs)}")
    return slugs


def default_band(levels, kinds, excited_Hz, rate):
    """Return (low, high) Hz: the excited lines, ended where next to nothing is left of the
    responses' velocity at the lowest level.
    """
    level = levels[0]
    inside = (level.frequency >= excited_Hz[0]) & (
        level.frequency <= min(excited_Hz[1], SHARPEST * rate)
    )
    frequency = level.frequency[inside]
    orders = np.array([1.0 - TIME_DERIVATIVES.get(kind, 0) for kind in kinds])
    power = (np.abs(level.response[:, inside]) * (2.0 * np.pi * frequency) ** orders[:, None]) ** 2
    share = np.cumsum(power, axis=1) / np.maximum(
        power.sum(axis=1, keepdims=True), np.finfo(float).tiny
    )
    last = max(int(np.searchsorted(row, ENOUGH)) for row in share)
    return float(frequency[0]), float(
        min(WIDER * frequency[min(last, frequency.size - 1)], frequency[-1])
    )


def own_study(name, asked, campaign, drive, band_Hz):
    """Return the Study of a campaign before its places are ranked: candidates, mounting and peak_Hz
    may still be empty.
    """
    names = [str(each) for each in campaign["channel_name"].values]
    places = (
        dict(asked.places)
        if asked.places
        else default_places(names, campaign["channel_direction"].values.astype(float))
    )
    if any(each.endswith(f".{ELSEWHERE}") for each in asked.additions or ()):
        places[ELSEWHERE] = None
    return Study(
        name=name,
        band_Hz=tuple(map(float, asked.band_Hz or band_Hz)),
        drive=names[drive],
        residual_modes=tuple(asked.residual_modes or (True, True)),
        mean=asked.mean,
        places=places,
        candidates=tuple(asked.candidates or ()),
        additions=tuple(asked.additions or ()),
        emphasis=float(asked.emphasis),
        mounting=asked.mounting or "",
        peak_Hz=tuple(map(float, asked.peak_Hz or ())),
        units=_units(campaign, drive),
    )


def _units(campaign, drive):
    """The units of laws where the response is no mechanical motion, from those of force and
    response in SI; {} for a mechanical one.
    """
    kind, moved = (str(campaign[f"channel_{key}"].values[drive]) for key in ("kind", "units"))
    if kind != "generic":
        return {}
    force, moved = si_unit(force_units(campaign, 0), "excitation"), si_unit(moved, kind)
    if force == moved:  # powers of one unit
        return {
            "N": force,
            "m": force,
            "N/m": "1",
            "N/m2": f"{force}-1",
            "N/m3": f"{force}-2",
            "N s/m": "s",
            "m/s": f"{force} s-1",
            "N s2/m2": f"s2 {force}-1",
        }
    return {
        "N": force,
        "m": moved,
        "N/m": f"{force}/({moved})",
        "N/m2": f"{force}/({moved})2",
        "N/m3": f"{force}/({moved})3",
        "N s/m": f"{force} s/({moved})",
        "m/s": f"({moved})/s",
        "N s2/m2": f"{force} s2/({moved})2",
    }
