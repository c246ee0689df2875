"""Whether the supports of a tube can be identified from a campaign: checks before any job."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from vibroimpact.campaign.force_kinds import BASE, force_kinds
from vibroimpact.campaign.signals import CampaignSignals
from vibroimpact.config.excitation import BandLimited
from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.schema import Config
from vibroimpact.diagnosis.measurement.comparable import comparison_problems

# The campaign brings the forces, or has none: that of the model must not be refused.
ANY_FORCE = BandLimited(
    kind="band_limited", point="any", direction=(0.0, 1.0, 0.0), band_Hz=(1.0, 2.0)
)
MOST_NAMED = 6


def identification_problems(config: Config, campaign: xr.Dataset) -> list[str]:
    """Return sentences on why a campaign, whose signals are not read, gives no supports of a model.

    campaign: Dataset that keeps the contract except for the force.
    """
    kind = config.structure.kind
    if kind not in TUBES:
        return [
            f"structure.kind = '{kind}': equivalent supports are read of tubes: give a model of"
            f" kind {' or '.join(TUBES)}"
        ]
    problems = [] if config.supports else ["the model has no supports: state them, with their gap"]
    if BASE in force_kinds(campaign):
        problems.append(
            "the base moved the structure: give records under forces, or leave the acceleration of"
            " the base out if motions are relative to it"
        )
    own = config.model_copy(update={"excitation": ANY_FORCE})
    return [*problems, *comparison_problems(own, campaign)]


def signal_problems(signals: CampaignSignals, segment_s: float) -> Iterator[str]:
    """Yield sentences on signals that can not be used, and on records shorter than a segment."""
    yield from signals.unit_faults.values()
    yield from signals.force_unit_faults.values()
    missing = [
        f"{name} in record {record}"
        for at, record in enumerate(signals.records)
        for name, series in (
            *zip(signals.forces, signals.force[at], strict=True),
            *zip(signals.channels, signals.response[at], strict=True),
        )
        if not (series.size and np.isfinite(series).all())
    ]
    if missing:
        more = len(missing) - MOST_NAMED
        others = f" and {more} more" if more > 0 else ""
        yield (
            f"samples are missing of {', '.join(missing[:MOST_NAMED])}{others}: cut the records, or"
            " leave these channels or records out"
        )
    still = [
        name
        for row, name in enumerate(signals.channels)
        if not any(np.any(response[row]) for response in signals.response)
    ]
    if still:
        yield f"{', '.join(still)} measured nothing but zeros: leave them out"
    shortest = float(signals.valid_samples.min() / signals.rate)
    if shortest < segment_s:
        record = signals.records[int(np.argmin(signals.valid_samples))]
        yield (
            f"record {record} lasts {shortest:.3g} s, less than a segment of {segment_s:g} s: give"
            f" the model spectra.segment_s below {0.25 * shortest:.2g} s"
        )
