"""Virtual sensors at the supports: contact forces and their statistics from remote sensors.

The model is held to the measured motion by dampers at the sensors (see integration.held_run). It
then follows the measured impacts one by one, and its contact forces are those of the structure.

Source: the task is that of M. De Araujo, J. Antunes, P. Piteau, Remote identification of impact
forces on loosely supported tubes, J. Sound Vib. 215 (1998) 1015-1041, who invert the propagation of
waves; here an observer gives the forces. Two runs driven by the same data agree only if the data
determine them: H. Abarbanel, N. Rulkov, M. Sushchik, Phys. Rev. E 53 (1996) 4528.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import CampaignError
from vibroimpact.config.schema import Config
from vibroimpact.identify.linear.support_groups import support_directions

from .comparison import Comparison
from .explanations import Point, Structure
from .gauss_newton import fit
from .measurement.comparable import channel_rows, comparison_problems, left_out, model_rows
from .measurement.sensed_motion import of_modes
from .measurement.signals import signals_of
from .support_statistics import (
    HeldTwice,
    agreement_of,
    estimates,
    force_channels,
    of_channel,
    unseen_of,
    with_interval,
)
from .whole_records import STRENGTH, Holder, first_mode_Hz

AGREEMENT = 0.95  # least correlation of the forces under two strengths
KNOWN = 0.5  # least share of signal in a channel
PASSES = 3  # of a calibration, at most: gains are then known to 1 %, see docs/virtual_supports.md

UNITS = {
    "rms_force": "N",
    "force_level": "N",
    "peak_force": "N",
    "contact_fraction": "1",
    "impact_rate": "s-1",
    "wear_work_rate": "W",
    "agreement": "1",
    "correlation": "1",
    "secant_stiffness": "N m-1",
    "secant_damping": "N s m-1",
}


@dataclass(frozen=True)
class SupportValue:
    """A quantity of a support in a record.

    load: RMS of the force in load_unit. gap_m: nominal gap, m. channel: a measured contact force
    that the quantity belongs to, "" for the resultant on the structure.
    value, low, high: in unit; low and high bound 90 % of the values of other stretches as long as
    the record, NaN if not known. measured: the same for the measured contact force, else NaN.
    remark: why the value is not reliable, else "".
    """

    record: str
    load: float
    load_unit: str
    gap_m: float
    support: str
    channel: str
    quantity: str
    unit: str
    value: float
    low: float
    high: float
    measured: float
    remark: str


@dataclass(frozen=True, eq=False)
class SupportForces:
    """Contact forces of a record.

    first_s: time of the first sample in the record. sampling_frequency: Hz.
    force (support, 2, sample): resultants on the structure, N, along directions (support, 2, 3).
    """

    record: str
    first_s: float
    sampling_frequency: float
    supports: tuple[str, ...]
    directions: np.ndarray
    force: np.ndarray


@dataclass(frozen=True, eq=False)
class VirtualSupports:
    """Contact forces at supports from remote sensors: values, forces if asked for, and notes."""

    values: tuple[SupportValue, ...]
    forces: tuple[SupportForces, ...]
    notes: tuple[str, ...]


def virtual_supports(
    campaign: xr.Dataset, config: Config, calibrate: bool = False, with_forces: bool = False
) -> VirtualSupports:
    """Return the VirtualSupports of every record of a measured campaign.

    Per support: contact force (RMS and peak of every step; level below which it is for 99.9 % of
    the time, in the band of the records), share of time in contact, impacts per second, wear work
    rate, secant stiffness and damping by direction. Definitions are those of a study's statistics.
    Measured contact forces are not used, only reported next to the virtual ones.

    config: of the model. calibrate: fit its frequencies and damping, and the gains, first.
    with_forces: also give the forces over time. Raises CampaignError if the campaign can not be
    compared with the model, with the reasons, one a line.
    """
    held, notes = _held_channels(campaign, config)
    own = campaign.isel(channel=held)
    signals = signals_of(own)
    structure = Structure(config, own)
    holding = Holder(structure, signals, Point())
    if problems := [*_unusable(holding)]:
        raise CampaignError("\n".join(problems))
    if calibrate:
        comparison = Comparison(signals, structure)
        fitted = fit(comparison.fitted(), Point(), comparison.nuisances(), PASSES)
        holding = Holder(structure, signals, fitted.point)
    channels, unplaced = force_channels(campaign, holding.model)
    notes += unplaced
    directions = support_directions(holding.model, "each")
    values: list[SupportValue] = []
    forces: list[SupportForces] = []
    for record in range(len(signals.record_names)):
        run, weaker = holding.hold(record), holding.hold(record, 0.5 * STRENGTH)
        values += _values(HeldTwice(holding, run, weaker, directions, channels))
        notes += _doubts(signals, run)
        if with_forces:
            forces.append(_forces(holding, run))
    return VirtualSupports(tuple(values), tuple(forces), tuple(dict.fromkeys(notes)))


def _held_channels(campaign, config):
    """Return (indices of the channels that are held, sentences on the others)."""
    problems = comparison_problems(config, campaign)
    if not config.supports:
        problems.append(
            "the model has no supports, whose forces could be told: give `supports` in its"
            " configuration"
        )
    if problems:
        raise CampaignError("\n".join(f"{problem}." for problem in problems))
    rows = [*channel_rows(campaign), *model_rows(config, campaign)]
    names = campaign["channel_name"].values
    told = of_modes(campaign["channel_kind"].values) & ~np.isin(names, sorted(left_out(rows)))
    held, notes = np.flatnonzero(told), [row["message"] for row in rows]
    if not len(held):
        notes.append(
            "no channel is left that measures a motion or a strain at a known place: the model can"
            " not be held."
        )
        raise CampaignError("\n".join(notes))
    return held, notes


def _unusable(holding) -> Iterator[str]:
    """Yield a sentence for every record that can not be held."""
    signals, period = holding.signals, 1.0 / first_mode_Hz(holding.model)
    open_gap = bool(np.isnan(holding.model.contact_laws.gap).any())
    for record, name in enumerate(signals.record_names):
        if open_gap and not np.isfinite(signals.gap[record]):
            yield f"gap[{record}] of record {name} is missing: give the radial gap in m."
        duration = holding.stretch_times(record)[1]
        if duration < period:
            yield (
                f"record {name} is too short: its stretches have {max(duration, 0.0):.3g} s, less"
                f" than a period of the first mode ({period:.3g} s); give longer records."
            )


def _doubts(signals, run) -> Iterator[str]:
    """Yield sentences on stretches of a record that diverged, and on channels of mostly noise."""
    record, force = signals.record_names[run.record], run.runs.support_force
    lost = int(np.sum(~np.isfinite(force).all(axis=(1, 2))))
    if lost:
        yield (
            f"record {record}: {lost} of its {len(force)} stretches diverged and are left out;"
            " raise integration.steps_per_second."
        )
    noisy = [name for name, share in zip(signals.names, run.known, strict=True) if share < KNOWN]
    if noisy:
        yield (
            f"record {record}: {', '.join(noisy)} {'is' if len(noisy) == 1 else 'are'} mostly noise"
            " as a velocity and hardly held; what depends on the motion along them, such as the"
            " wear work rate, is then not known."
        )


def _forces(holding, run) -> SupportForces:
    """Return the SupportForces of a held record."""
    model = holding.model
    names = tuple(model.support_names)
    first = [int(np.flatnonzero(model.support_of_point == k)[0]) for k in range(len(names))]
    return SupportForces(
        holding.signals.record_names[run.record],
        run.first_s,
        holding.rates.sampling,
        names,
        model.contact_directions[first],
        run.support_force.reshape(len(names), 2, -1),
    )


def _values(record: HeldTwice) -> Iterator[SupportValue]:
    """Yield the SupportValues of a record, none if all of its stretches diverged."""
    signals, number = record.holder.signals, record.run.record
    supports = record.holder.model.support_names
    force = record.run.runs.support_force
    fine = np.flatnonzero(np.isfinite(force).all(axis=(1, 2)))
    if not len(fine):
        return
    found = with_interval(lambda chosen: estimates(record, chosen), fine)
    agreement, unseen = agreement_of(record, fine), unseen_of(record)
    measured = {
        key: value
        for channel in record.channels
        for key, value in of_channel(channel, record.side_by_side[channel.name][1, fine]).items()
    }
    for support in range(len(supports)):
        found[support, "", "agreement"] = float(agreement[support]), np.nan, np.nan
    for key in sorted(found, key=lambda key: key[:2]):
        support, channel, quantity = key
        yield SupportValue(
            signals.record_names[number],
            float(signals.load[number]),
            signals.load_unit,
            float(signals.gap[number]),
            supports[support],
            channel,
            quantity,
            UNITS[quantity.rsplit("_", 1)[0] if "secant" in quantity else quantity],
            *found[key],
            measured.get(key, np.nan),
            _remark(quantity, agreement[support], unseen[support]),
        )


def _remark(quantity, agreement, unseen):
    """Return why a quantity is not reliable, "" if it is; unseen: directions there."""
    if agreement < AGREEMENT:
        return f"not held: forces under two strengths agree to {agreement:.2f}"
    along = quantity.rsplit("_", 1)[-1]
    if unseen and (quantity == "wear_work_rate" or along in unseen):
        return f"no sensor sees the motion along {' and '.join(unseen)}"
    return ""
