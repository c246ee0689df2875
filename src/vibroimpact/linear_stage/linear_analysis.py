"""The linear stage: checks of a campaign, what its lowest record tells, and the linear effects that
are adopted before contact is looked at.
"""

from dataclasses import dataclass, field, replace
from functools import partial
from math import ceil

import numpy as np

from vibroimpact.campaign.base_motion import relative_to_base
from vibroimpact.campaign.checks.file_checks import check_file, refused, usable_signals
from vibroimpact.campaign.checks.model_comparison import compare_with_model
from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.campaign.file import CampaignError, read_campaign
from vibroimpact.campaign.signals import campaign_signals, transfer
from vibroimpact.discrepancy import priors
from vibroimpact.discrepancy.misfit import counted
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
    strain_rows,
)
from vibroimpact.observation.decimation import slower
from vibroimpact.observation.sensed_motion import differentiated, kind_groups
from vibroimpact.observation.sensor_chain import Measuring
from vibroimpact.observation.strain import STRAIN, speed_per_strain
from vibroimpact.units import TIME_DERIVATIVES

from .adopted import adopt
from .candidates import candidate_named, local_candidates, not_testable
from .effect_table import held, nearest_linear
from .lowest_record import read_lowest
from .modal_fit import ModalFit
from .nearest_model import translated
from .nonlinear_substitutes import in_place
from .nuisance import neutral, plausible
from .scales import scales
from .workbench import Workbench, corrected_nuisance


@dataclass
class Prepared:
    """What the linear stage hands on, in plain values.

    checks: rows of the validator and of this stage; refusal: sentence, None where the campaign can
    be tested; scales {name: value}; adopted: None or {name, unit, gain, interval} of the linear
    effect, or two (a Pair's name), that belong to the model from here on; linear: the same of every
    linear candidate, best first; screened: names of the candidates that only simulation tells of;
    in_place: those that may be what the lowest record took for what is adopted; linear_stage:
    whether the lowest record tells of the linear structure; still_linear: whether it does with what
    is adopted, or touches then; nonlinear_low: the lowest record is not that of a linear structure;
    chi_square of the lowest record; residual (channel,) over noise; delays {channel: s}; fit: the
    ModalFit of the lowest record on the model with what was adopted; draw: see prepare.
    """

    checks: list
    refusal: str | None = None
    scales: dict = field(default_factory=dict)
    adopted: dict | None = None
    linear: list = field(default_factory=list)
    screened: list = field(default_factory=list)
    in_place: list = field(default_factory=list)
    linear_stage: bool = False
    still_linear: bool = False
    nonlinear_low: bool = False
    chi_square: float = 0.0
    residual: list = field(default_factory=list)
    delays: dict = field(default_factory=dict)
    not_testable: list = field(default_factory=list)
    fit: dict | None = None
    draw: int = 0

    def room(self, candidate):
        """Return whether a Candidate or Pair may be missing beside what was adopted, or in its
        place: no more than priors.MOST_EFFECTS are named.
        """
        adopted = (
            []
            if self.adopted is None or candidate.alone
            else candidate_named(self.adopted["name"]).ids
        )
        return len(adopted) + len(candidate.ids) <= priors.MOST_EFFECTS

    def beside_or_in_place(self, candidate):
        """Return the Candidates that one is simulated as: beside what was adopted where there is
        room, in its place where it may be what that was taken for.
        """
        return [candidate] * self.room(candidate) + [replace(candidate, alone=True)] * (
            candidate.name in self.in_place
        )


def usable_campaign(path, checks, integration):
    """Return (campaign Dataset, sentence or None): without the channels and records that the checks
    leave out, at the sampling rate that it is compared at, and why that is too little.
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
    channels = np.flatnonzero(response[records].all(axis=0)) if len(records) else []
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
        # a channel that fails in one record alone costs the record where that leaves more to look
        # at
        records = np.flatnonzero(force & response.all(axis=1))
        channels = np.arange(response.shape[1])
    if len(records) < 2:
        return None, "Fewer than two records are left after the checks: repair what they name."
    return slower(campaign.isel(record=records, channel=channels), integration), None


def workbench(config, campaign_path, prepared, seconds=None):
    """Return the Workbench of a campaign, each record cut to so many seconds (None: whole), as the
    linear stage left it: nuisances corrected, the linear effects adopted.
    """
    campaign, refusal = usable_campaign(campaign_path, prepared.checks, config.integration)
    if refusal:
        raise CampaignError(refusal)
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
        # what bends the record would be taken for nuisances: they are told beside a candidate alone
        if bench.nonlinear_low and not plausible(pulls):
            bench.nuisance, bench.modes_told = (
                neutral(bench.measured_fit.modes, len(bench.signals.names)),
                False,
            )
    return bench


def prepare(config, campaign_path, draw=0):
    """Return the Prepared of a campaign file and a checked Config; draw: number of the draw of
    seeds, of which verdicts shall not depend.
    """
    whole, checks = check_file(campaign_path)
    if whole is not None and not refused(checks):
        checks += channel_rows(whole)
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
    out.in_place = taken_for_linear(bench, fresh, out, candidates)
    out.screened = [candidate.name for candidate in candidates if out.beside_or_in_place(candidate)]
    # a linear effect may be what makes it touch: those that come nearest are simulated where they
    # look best
    if out.linear_stage and out.nonlinear_low:
        out.screened += [name for name in nearest_linear(out.linear) if name not in out.screened]
    return out


def read_s(records, duration_s):
    """Return the seconds that are read of each of so many records: less where they fill more than
    one batch.
    """
    return min(max(priors.READ_S / ceil(records / LANES), priors.LEAST_READ_S), duration_s)


def largest_motion(signals):
    """Return m, what the response at the highest load would be at the low end of the band, of the
    kind of motion that tells most; 0 where no channel measures a motion.
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


def motion_of_strains(signals, structure):
    """Return m, the same of the speed that goes with the strains of a tube (section of a
    configuration); 0 where no channel measures one.
    """
    gauges = signals.kinds == STRAIN
    if not gauges.any():
        return 0.0
    strain = float(np.nanstd(signals.response[signals.load.argmax()][gauges]))
    return strain * speed_per_strain(structure) / (2.0 * np.pi * signals.band_Hz[0])


def taken_for_linear(bench, fresh, prepared, candidates):
    """Return the names of the Candidates that may stand in the place of what a Prepared adopts,
    none where that is nothing, or a fault of the measuring chain.

    bench: Workbench with what is adopted; fresh() gives another one.
    """
    if prepared.adopted is None or candidate_named(prepared.adopted["name"]).effect.measured:
        return []
    # it touches with what is adopted, or shows no modes then: there is nothing to rule a place out
    # by
    if not bench.linear_stage:
        return [candidate.name for candidate in candidates if candidate.effect.below_contact]
    bare = fresh()
    bare.measured_fit = translated(bench.measured_fit, bench.bare, bare.bare)
    return in_place(bare, candidates, prepared.adopted["gain"], prepared.scales["tube_translation"])


def telling_modes(prepared, shown):
    """Return those of the modes that the lowest record shows by which it tells of linear effects,
    None where these are candidates as the others are.

    A record that something bends shows modes, yet tells wrong which linear effect there is beside
    it: a press that holds the tube hid nine times its damping.
    """
    return shown if prepared.linear_stage and not prepared.nonlinear_low else None


def mixed_up(bench):
    """Return the rows of checks for channels that the bare linear model contradicts at the lowest
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


def beside_first(measured, record, lines):
    """Return (force_channel, line): what of each force of CampaignSignals goes with the first in a
    record, 1 for that itself, at the lines of its transfer.
    """
    others = [force[1:] for force in measured.force]
    if not len(others[record]):
        return np.ones((1, lines))
    alone = replace(measured, response=others)
    return np.concatenate([np.ones((1, lines)), transfer(alone, record).h1])


CONTRADICTED = (
    "swapped channels",
    "directions",
)  # of the rows of mixed_up: these channels are left out
