"""The linear stage as a whole: checks of a campaign, the analysis of its lowest record, and the
linear effects that are adopted before contact is examined.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.campaign.base_motion import relative_to_base
from vibroimpact.campaign.checks.file_checks import check_file, refused, usable_signals
from vibroimpact.campaign.checks.model_comparison import compare_with_model
from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.campaign.file import CampaignError, read_campaign
from vibroimpact.campaign.signals import CampaignSignals, campaign_signals, transfer
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.effects.places import length_m
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.observation.comparable import (
    LEFT_OUT,
    campaign_problems,
    channel_rows,
    compared_channels,
    comparison_problems,
    contact_force_rows,
    left_out,
    still_rows,
    strain_rows,
)
from vibroimpact.observation.decimation import slower
from vibroimpact.observation.sensed_motion import differentiated, kind_groups
from vibroimpact.observation.sensor_chain import Measuring
from vibroimpact.observation.signals import Signals
from vibroimpact.observation.strain import STRAIN, speed_per_strain
from vibroimpact.units import TIME_DERIVATIVES

from . import priors
from .adopted import adopt
from .candidates import Candidate, candidate_named, local_candidates, not_testable
from .counted_cells import counted
from .effect_table import held, nearest_linear
from .lowest_record import read_lowest
from .modal_fit import ModalFit
from .nearest_model import translated
from .nonlinear_substitutes import LEAST_SHARE, in_place
from .nuisance import neutral, plausible
from .prepared import Prepared
from .scales import scales
from .springs_across import across_the_force
from .workbench import Workbench, corrected_nuisance


def usable_campaign(
    path: str | Path, checks: list[dict[str, Any]], integration: ConfigPart
) -> tuple[xr.Dataset | Any, str | None]:  # Any, not None: callers look at the sentence first
    """Return (campaign Dataset, None), without the channels and records that the checks leave out
    and at the sampling rate at which it is compared; (None, sentence) where nothing usable is left.

    integration: section of a configuration.
    """
    if refused(checks):
        return None, next(row["message"] for row in checks if row["level"] == "refuse")
    try:
        campaign = read_campaign(path)
    except (CampaignError, ValueError) as error:
        return None, str(error)
    force, response = usable_signals(campaign, checks)
    names = campaign["channel_name"].values
    known = compared_channels(campaign)
    compared = np.flatnonzero(known & ~np.isin(names, list(left_out(checks))))
    if not known.any():
        return None, campaign_problems(campaign)[0]
    if not compared.size:
        return None, next(row["message"] for row in checks if row["check"] == LEFT_OUT)
    campaign, response = campaign.isel(channel=compared), response[:, compared]
    records = np.flatnonzero(force)
    channels: np.ndarray | list[int] = (
        np.flatnonzero(response[records].all(axis=0)) if len(records) else []
    )
    contradicted = {
        row["channel"]
        for row in checks
        if row["check"] in CONTRADICTED and row["level"] == "warn" and row["record"] is not None
    }
    channels = np.array(
        [
            channel
            for channel in channels
            if str(campaign["channel_name"].values[channel]) not in contradicted
        ],
        int,
    )
    if len(records) < 2 or len(channels) < 1:
        # where every channel fails in some record, or too few records are left, leave out records
        # with a failing channel instead
        records = np.flatnonzero(force & response.all(axis=1))
        channels = np.arange(response.shape[1])
    if len(records) < 2:
        return None, "Fewer than two records are left after the checks: repair what they name."
    return slower(campaign.isel(record=records, channel=channels), integration), None


def workbench(
    config: ConfigPart, campaign_path: str | Path, prepared: Prepared, seconds: float | None = None
) -> Workbench:
    """Return the Workbench of a campaign with the results of the linear stage: nuisances corrected,
    the linear effects adopted. Each record is cut to so many seconds, None for whole records.

    Raises CampaignError where the checks leave nothing usable.
    """
    campaign, refusal = usable_campaign(campaign_path, prepared.checks, config.integration)
    if refusal:
        raise CampaignError(refusal)
    if prepared.fitted:
        chosen = campaign["record_name"].isin(prepared.fitted)
        campaign = campaign.assign(split=campaign["split"].where(~chosen, "fit"))
    bench = Workbench(config, campaign, seconds, prepared.draw)
    bench.linear_stage, bench.nonlinear_low = prepared.linear_stage, prepared.nonlinear_low
    if prepared.delays:
        delay = np.array([prepared.delays.get(name, 0.0) for name in bench.signals.names])
        bench.late = Measuring(np.ones(len(delay)), delay, 1.0)
    if prepared.adopted is not None:
        adopt(bench, prepared, prepared.still_linear)
    elif prepared.linear_stage:
        if prepared.fit is not None:
            bench.measured_fit = ModalFit(
                **{name: np.array(value) for name, value in prepared.fit.items()}
            )
        bench.nuisance, _, _, pulls = corrected_nuisance(bench)
        # a nonlinear response would be mistaken for nuisances: they are identified only together
        # with a candidate
        if bench.nonlinear_low and not plausible(pulls):
            bench.nuisance, bench.modes_told = (
                neutral(bench.measured_fit.modes, len(bench.signals.names)),
                False,
            )
    return bench


def prepare(config: ConfigPart, campaign_path: str | Path, draw: int = 0) -> Prepared:
    """Return the Prepared of a campaign file and a checked Config; draw: number of the draw of
    seeds, on which verdicts must not depend.
    """
    whole, checks = check_file(campaign_path)
    if whole is not None and not refused(checks):
        checks += [*channel_rows(whole), *still_rows(config, whole)]
        checks += [
            check_row("model", "refuse", f"{problem}.")
            for problem in comparison_problems(config, whole)
        ]
    campaign, refusal = usable_campaign(campaign_path, checks, config.integration)
    if refusal is None:
        try:
            whole_s = campaign.sizes["time"] / float(campaign.attrs["sampling_frequency"])
            seconds = read_s(campaign.sizes["record"], whole_s)
            bench = Workbench(config, campaign, seconds)
            mixed = [
                *strain_rows(config, campaign),
                *mixed_up(bench),
                *contact_force_rows(bench.bare, bench.signals),
            ]
            if mixed:
                before, checks = campaign.sizes, [*checks, *mixed]
                campaign, refusal = usable_campaign(campaign_path, checks, config.integration)
                if refusal is None and campaign.sizes != before:  # something was left out
                    bench = Workbench(config, campaign, seconds)
        except CampaignError as error:
            checks = [
                *checks,
                {
                    "check": "places",
                    "level": "refuse",
                    "record": None,
                    "channel": None,
                    "message": str(error),
                },
            ]
            refusal = str(error)
    if refusal is None and not counted(bench).any():
        refusal = (
            f"Of {', '.join(bench.signals.names)} none shows motion above its noise in any band, so"
            " there is nothing to compare: repair what other checks name, or measure where the"
            " structure moves."
        )
        checks = [*checks, check_row("content", "refuse", refusal)]
    if refusal is not None:
        return Prepared(checks, refusal)
    out = Prepared(
        checks,
        not_testable=not_testable(held(campaign)),
        draw=draw,
    )
    gap = bench.signals.gap[np.isfinite(bench.signals.gap)]
    moved = largest_motion(bench.signals) or motion_of_strains(
        bench.signals, bench.config.structure
    )
    reach = float(gap.max()) if len(gap) else moved
    first = bench.bare.frequencies[bench.bare.omega > 0.0][0]
    out.scales = {
        name: float(value)
        for name, value in scales(
            bench.bare,
            bench.signals,
            {"displacement": reach, "speed": reach * 2.0 * np.pi * first},
            length_m(bench.values),
        ).items()
    }
    out.linear_stage = bool(bench.linear_stage)
    fresh = partial(Workbench, config, campaign, seconds)
    if out.linear_stage:
        bench = read_lowest(bench, fresh, out)
    shown = out.fit["modes"] if out.fit else bench.measured_fit.modes if out.linear_stage else None
    candidates = local_candidates(bench.given, held(campaign), telling_modes(out, shown))
    out.still_linear = bool(bench.linear_stage)
    across = across_too(bench, fresh, out)
    out.in_place = taken_for_linear(bench, fresh, out, candidates)
    candidates += across
    if out.adopted is not None:
        out.in_place += [candidate.name for candidate in across]
    out.screened = [candidate.name for candidate in candidates if out.beside_or_in_place(candidate)]
    # contact may be the consequence of a linear effect: the best of them are simulated where they
    # fit best
    if out.linear_stage and out.nonlinear_low:
        out.screened += [name for name in nearest_linear(out.linear) if name not in out.screened]
    return out


def read_s(records: int, duration_s: float) -> float:
    """Return the seconds that are analysed of each of so many records: fewer where they fill more
    than one batch.
    """
    return min(max(priors.READ_S / ceil(records / LANES), priors.LEAST_READ_S), duration_s)


def largest_motion(signals: Signals) -> float:
    """Return the displacement in m that the response at the highest load would be at the low end of
    the band, for the kind of motion that gives most; 0 where no channel measures a motion.
    """
    response, low = signals.response[signals.load.argmax()], 2.0 * np.pi * signals.band_Hz[0]
    return max(
        (
            float(np.nanstd(response[own]) / low ** TIME_DERIVATIVES[kind])
            for kind, own in kind_groups(signals.kinds).items()
            if kind in TIME_DERIVATIVES
        ),
        default=0.0,
    )


def motion_of_strains(signals: Signals, structure: ConfigPart) -> float:
    """Return the same in m for the speed that goes with the strains of a tube; 0 where no channel
    measures a strain. structure: section of a configuration.
    """
    gauges = signals.kinds == STRAIN
    if not gauges.any():
        return 0.0
    strain = float(np.nanstd(signals.response[signals.load.argmax()][gauges]))
    return strain * speed_per_strain(structure) / (2.0 * np.pi * signals.band_Hz[0])


def across_too(
    bench: Workbench, fresh: Callable[[], Workbench], prepared: Prepared
) -> list[Candidate]:
    """Return the Candidates that act across the force where the lowest record shows a spring that
    does, see springs_across.across_the_force; arguments as in taken_for_linear.
    """
    unexplained = prepared.adopted is not None or prepared.nonlinear_low
    if not (prepared.linear_stage and unexplained) or prepared.other_structure:
        return []
    bare = fresh()
    bare.measured_fit = translated(bench.measured_fit, bench.bare, bare.bare)
    gain = LEAST_SHARE * prepared.adopted["gain"] if prepared.adopted is not None else 0.0
    return across_the_force(bare, gain, prepared.scales["tube_translation"])


def taken_for_linear(
    bench: Workbench,
    fresh: Callable[[], Workbench],
    prepared: Prepared,
    candidates: Sequence[Candidate],
) -> list[str]:
    """Return the names of the Candidates that may explain the lowest record instead of what a
    Prepared adopts, none where that is nothing, or a fault of the measuring chain.

    bench: Workbench with what is adopted; fresh() gives one without it.
    """
    if prepared.adopted is None or candidate_named(prepared.adopted["name"]).effect.measured:
        return []
    # with what is adopted the model touches, or no mode is seen: no place can be ruled out
    if not bench.linear_stage:
        return [candidate.name for candidate in candidates if candidate.effect.below_contact]
    bare = fresh()
    bare.measured_fit = translated(bench.measured_fit, bench.bare, bare.bare)
    return in_place(bare, candidates, prepared.adopted["gain"], prepared.scales["tube_translation"])


def telling_modes(
    prepared: Prepared, shown: Sequence[int] | np.ndarray | None
) -> Sequence[int] | np.ndarray | None:
    """Return the modes that the lowest record shows where they identify linear effects, None where
    linear effects are simulated as the others are.

    A record with a nonlinear response shows modes, but identifies the wrong linear effect: a press
    on the tube hid nine times its damping.
    """
    return shown if prepared.linear_stage and not prepared.nonlinear_low else None


def mixed_up(bench: Workbench) -> list[dict[str, Any]]:
    """Return the rows of checks for channels that contradict the bare linear model at the lowest
    level: swapped, reversed, in another unit.
    """
    if not bench.linear_stage:
        return []
    measured = relative_to_base(campaign_signals(bench.campaign))
    spectra = transfer(measured, bench.signals.lowest)
    if spectra is None:
        return []
    omega, model = 2.0 * np.pi * spectra.frequency, bench.bare
    receptance = np.einsum(
        "mc,ml,ml->cl",
        model.sensor_shapes,
        model.drive_shapes @ beside_first(measured, bench.signals.lowest, omega.size),
        1.0 / (model.omega[:, None] ** 2 - omega**2 + 1j * model.damping[:, None] * omega),
    )
    motion = np.array([differentiated(omega, kind) for kind in measured.kinds])
    return compare_with_model(
        spectra,
        motion * receptance,
        measured.channels,
        measured.kinds,
        measured.records[bench.signals.lowest],
    )


def beside_first(measured: CampaignSignals, record: int, lines: int) -> np.ndarray:
    """Return (force_channel, line): the transfer functions from the first force of CampaignSignals
    to each force in a record, 1 for the first itself; lines: their number.
    """
    others = [force[1:] for force in measured.force]
    if not len(others[record]):
        return np.ones((1, lines))
    spectra = transfer(replace(measured, response=others), record)
    assert spectra is not None, "the record is long enough for transfer functions"
    return np.concatenate([np.ones((1, lines)), spectra.h1])


# of the rows of mixed_up: these channels are left out
CONTRADICTED = ("swapped channels", "directions")
