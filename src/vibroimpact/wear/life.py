"""The wear life of the supports of a finished study."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.reading import load_config
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.config.supports import Support
from vibroimpact.geometry.sections import section_kind
from vibroimpact.io.records import read_record

from .depth import YEAR_S, depth_of, volume_of

ROUND_HOLES = ("circular", "drilled", "lobes")


class NoWear(ValueError):
    """A study that has no wear life."""


@dataclass(frozen=True)
class WearRow:
    """The wear of the tube at one support, at one load and gap, with one coefficient.

    work_rate_W: median over seeds. depth_m: no deeper than the wall. years_to_limit: until `limit`
    of the wall is worn, infinite without work.
    """

    load_rms_N: float
    gap_m: float
    support: str
    work_rate_W: float
    coefficient_m2_per_N: float
    volume_m3: float
    depth_m: float
    wall_share: float
    years_to_limit: float


@dataclass(frozen=True)
class Service:
    """How long a tube is in service.

    coefficients: of wear, m²/N. years, duty: time, and the share of it under this load. limit: of
    the wall, at which a tube is plugged.
    """

    coefficients: tuple[float, ...]
    years: float = 40.0
    duty: float = 1.0
    limit: float = 0.4


def wear_life(folder: str | Path, service: Service) -> list[WearRow]:
    """Return the WearRows of a study's folder, by gap, load, support and coefficient.

    All work of a support wears one place of the tube: with a bore the crescent of that bore, with
    flat lands or bars one flat, over the height of the support. Raises NoWear, ConfigError,
    RecordError.
    """
    folder = Path(folder)
    records = sorted((folder / "records").glob("*.nc"))
    if not records:
        raise NoWear(f"{folder / 'records'}: there are no records: give the results of a study")
    config = load_config(folder / "config.yaml")
    structure: ConfigPart = config.structure
    if structure.kind not in TUBES or section_kind(structure.section) != "tube":
        raise NoWear(f"{folder}: wear life is that of the wall of a tube, this structure has none")
    section = structure.section
    supports = {support.name: support for support in config.supports}
    rows = []
    for (load, gap), rates in sorted(_rates(records).items(), key=lambda item: item[0][::-1]):
        for name, seeds in rates.items():
            shape = _shape(supports[name], gap, 0.5 * section.outer_diameter_m)
            wall = section.wall_thickness_m
            rows += list(_rows((load, gap, name), float(np.median(seeds)), shape, wall, service))
    return rows


def _rates(records: Sequence[Path]) -> dict[tuple[float, float], dict[str, list[float]]]:
    """Return {(load, gap): {support: work rates in W of its seeds}}."""
    found: dict[tuple[float, float], dict[str, list[float]]] = {}
    for path in records:
        record = read_record(path)
        own = found.setdefault(
            (float(record.attrs["load_rms_N"]), float(record.attrs["gap_m"])), {}
        )
        rates = record["wear_work_rate"].values
        for name, rate in zip(record["support"].values, rates, strict=True):
            own.setdefault(str(name), []).append(float(rate))
    return found


def _shape(support: Support, gap: float, radius: float) -> tuple[float, float, float]:
    """Return (length, radius, radius of the bore), m; the last one infinite for flat lands."""
    factor = float(np.mean(support.gap_factor))
    clearance = gap * factor if support.gap_m is None else support.gap_m
    bore = radius + clearance if support.profile.kind in ROUND_HOLES else np.inf
    if support.height_m is None:
        raise NoWear(f"support {support.name}: it has no height_m, over which the tube wears")
    return support.height_m, radius, bore


def _rows(
    place: tuple[float, float, str],
    rate: float,
    shape: tuple[float, float, float],
    wall: float,
    service: Service,
) -> Iterator[WearRow]:
    """Yield the rows of a support, one per coefficient."""
    limit = volume_of(service.limit * wall, *shape)
    for coefficient in service.coefficients:
        per_year = coefficient * rate * service.duty * YEAR_S
        volume = per_year * service.years
        depth = min(depth_of(volume, *shape), wall)  # then it is worn through
        yield WearRow(
            *place,
            rate,
            coefficient,
            volume,
            depth,
            depth / wall,
            limit / per_year if per_year > 0.0 else np.inf,
        )
