"""The wear life of the lands of the supports of a finished study."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.profiles import has_flat_lands
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.config.supports import Support
from vibroimpact.config.wear import Wear
from vibroimpact.geometry.sections import section_kind
from vibroimpact.io.records import read_record

from .laws import YEAR_S, Archard, EdfMz, WearLaw, WornShape, depth_of, published_laws, volume_of

STEPS = 200  # of depth through the wall, each with the work rate of its gap
Rates = dict[tuple[float, float], dict[tuple[str, int], float]]


class NoWear(ValueError):
    """A study that has no wear life."""


@dataclass(frozen=True)
class WearRow:
    """The wear of the tube at one land of a support, at one load and gap, by one law.

    land: counted from 1 in the order of the support's profile. work_rate_W: median over seeds.
    coefficient_m2_per_N: None for a law without one. volume_m3: worn off the tube. depth_m: no
    deeper than the wall. years_to_limit: until wall_limit is worn, infinite without work.
    """

    load_rms_N: float
    gap_m: float
    support: str
    land: int
    work_rate_W: float
    law: str
    coefficient_m2_per_N: float | None
    volume_m3: float
    depth_m: float
    wall_share: float
    years_to_limit: float


def wear_laws(support: Support, wear: Wear) -> Sequence[WearLaw]:
    """Return the laws of wear at a support; the published ones of its shape if none is given."""
    laws: list[WearLaw] = [Archard(value) for value in wear.coefficient_m2_per_N]
    laws += [EdfMz()] if wear.slowing else []
    if laws:
        return laws
    if support.profile.kind in ("lobes", "broached"):
        return published_laws("quadrifoil")
    return published_laws("bars" if has_flat_lands(support.profile) else "drilled")


def wear_rows(config: ConfigPart, records: Sequence[str | Path], wear: Wear) -> list[WearRow]:
    """Return the WearRows of records, by gap, load, support, land and law.

    A hole wears a crescent, a flat land or bar a flat, over the height of the support. Lands that
    do no work are left out, except the first of a support without any. Raises NoWear, RecordError.
    """
    structure: ConfigPart = config.structure
    if structure.kind not in TUBES or section_kind(structure.section) != "tube":
        raise NoWear("wear life is that of the wall of a tube, and this structure has none")
    rates, supports = work_rates(records), {support.name: support for support in config.supports}
    rows: list[WearRow] = []
    for load, gap in sorted(rates, key=lambda case: case[::-1]):
        for (name, land), rate in rates[load, gap].items():
            support = supports[name]
            shape = worn_shape(support, gap, 0.5 * structure.section.outer_diameter_m, wear)
            power = _power_of_depth(rates, (load, gap, name, land), support, wear.gap_grows)
            wall = structure.section.wall_thickness_m
            rows += [
                WearRow(load, gap, name, land, rate, law.name, law.coefficient, *found)
                for law in wear_laws(support, wear)
                for found in [worn_life(law, power, shape, wall, wear)]
            ]
    return rows


def worn_life(
    law: WearLaw,
    power: Callable[[np.ndarray], np.ndarray],
    shape: WornShape,
    wall: float,
    wear: Wear,
) -> tuple[float, float, float, float]:
    """Return (volume in m³, depth in m, share of the wall, years to the limit).

    power: function of depths in m that returns the work rates in W. wall: thickness, m.
    In each step of depth the law runs on from the volume worn so far, with the work rate there.
    """
    depths = np.linspace(0.0, wall, STEPS + 1)
    volumes = volume_of(depths, shape)
    rates = power(0.5 * (depths[1:] + depths[:-1]))
    if not rates[0] > 0.0:
        return 0.0, 0.0, 0.0, np.inf
    with np.errstate(invalid="ignore"):  # inf - inf beyond a gap at which nothing works any more
        steps = law.seconds(volumes[1:], rates) - law.seconds(volumes[:-1], rates)
    seconds = np.append(0.0, np.cumsum(np.nan_to_num(steps, nan=np.inf, posinf=np.inf)))
    years = seconds / (wear.duty * YEAR_S)
    volume = float(np.interp(wear.years, years, volumes))
    depth = min(depth_of(volume, shape), wall)  # then it is worn through
    limit = np.interp(volume_of(wear.wall_limit * wall, shape), volumes, years)
    return volume, depth, depth / wall, float(np.nan_to_num(limit, nan=np.inf, posinf=np.inf))


def work_rates(records: Sequence[str | Path]) -> Rates:
    """Return {(load in N, gap in m): {(support, land): work rate in W}}, medians over seeds.

    Raises NoWear for records of single steps.
    """
    found: dict[tuple[float, float], dict[tuple[str, int], list[float]]] = {}
    for path in records:
        record = read_record(path)
        if "wear_work_rate" not in record:
            raise NoWear(f"{path}: a record of single steps has no wear work rate")
        case = float(record.attrs["load_rms_N"]), float(record.attrs["gap_m"])
        rates = record["wear_work_rate"].values[:, None]
        if "land_work_rate" in record:
            rates = record["land_work_rate"].values
        for name, lands in zip(record["support"].values, rates, strict=True):
            for land, rate in enumerate(lands, 1):
                found.setdefault(case, {}).setdefault((str(name), land), []).append(float(rate))
    medians = {
        case: {place: float(np.median(seeds)) for place, seeds in places.items()}
        for case, places in found.items()
    }
    working = {place for places in medians.values() for place, rate in places.items() if rate > 0.0}
    busy = {name for name, _ in working}
    return {
        case: {
            (name, land): rate
            for (name, land), rate in places.items()
            if (name, land) in working or (land == 1 and name not in busy)
        }
        for case, places in medians.items()
    }


def worn_shape(support: Support, gap: float, radius: float, wear: Wear) -> WornShape:
    """Return the shape that a support wears into a tube of a radius in m at the case's gap in m.

    Raises NoWear for a support without a height.
    """
    if support.height_m is None:
        raise NoWear(f"support {support.name}: it has no height_m, over which the tube wears")
    flat = has_flat_lands(support.profile)
    clearance = gap * _gap_factor(support) if support.gap_m is None else support.gap_m
    return WornShape(
        support.height_m,
        radius,
        bore=np.inf if flat else radius + clearance,
        tilt=np.deg2rad(wear.tilt_deg) if flat else 0.0,
        tube_share=wear.tube_share,
    )


def _power_of_depth(
    rates: Rates, place: tuple[float, float, str, int], support: Support, grows: bool
) -> Callable[[np.ndarray], np.ndarray]:
    """Return the work rate of a land as a function of the depth: that of the study at the case's
    gap plus the depth, interpolated between its gaps and held beyond the largest.
    """
    load, gap, name, land = place
    gaps = sorted(other for amount, other in rates if amount == load)
    if not grows or support.gap_m is not None or support.preload_N is not None:
        gaps = [gap]
    powers = [rates[load, other][name, land] for other in gaps]
    factor = _gap_factor(support)
    return lambda depth: np.interp(gap + depth / factor, gaps, powers)


def _gap_factor(support: Support) -> float:
    """Return the mean factor of the case's gap at a support."""
    return float(np.mean(support.gap_factor))


def deepest(rows: Sequence[WearRow]) -> Iterator[list[WearRow]]:
    """Yield for each gap and load the rows, one per law, of the land that wears most."""
    cases: dict[tuple[float, float], dict[tuple[str, int], list[WearRow]]] = {}
    for row in rows:
        places = cases.setdefault((row.gap_m, row.load_rms_N), {})
        places.setdefault((row.support, row.land), []).append(row)
    for places in cases.values():
        yield max(places.values(), key=wear_rank)


def wear_rank(rows: Sequence[WearRow]) -> tuple[float, float]:
    """Return the rank of the rows of a land: by depth, then by the time to the limit."""
    return max(row.depth_m for row in rows), -min(row.years_to_limit for row in rows)
