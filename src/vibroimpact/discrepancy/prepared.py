"""The linear stage: checks, what the lowest record tells by itself, the linear effects that are
adopted before contact is looked at.
"""

from dataclasses import asdict, dataclass, field, replace
from functools import partial
from math import ceil

import numpy as np

from vibroimpact.campaign.base_motion import relative_to_base
from vibroimpact.campaign.checks.file_checks import check_file, refused, usable_signals
from vibroimpact.campaign.checks.model_comparison import compare_with_model
from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.campaign.file import CampaignError, read_campaign
from vibroimpact.campaign.signals import campaign_signals, transfer
from vibroimpact.effects.places import length_m
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.units import TIME_DERIVATIVES

from . import priors
from .acting_place import acting_place
from .candidates import candidate_named, local_candidates, not_testable
from .comparable import (
    LEFT_OUT,
    campaign_problems,
    channel_rows,
    compared_channels,
    comparison_problems,
    contact_force_rows,
    left_out,
    strain_rows,
)
from .driven import driven_channels
from .in_place import in_place
from .lags import driven_modes
from .linear_findings import linear_findings
from .linear_fit import LinearChanges
from .linear_misfit import LinearMisfit
from .linear_rows import held, linear_rows, nameable, nearest_linear
from .linear_stage import left
from .measuring import Measuring
from .modal_fit import ModalFit
from .nearest_model import fit_from_nearest, translated
from .nuisance import neutral, plausible
from .scales import scales, searched
from .sensed import differentiated, kind_groups
from .slower import slower
from .strain import STRAIN, speed_per_strain
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


def adopt(bench, prepared, linear_stage=None):
    """Put the adopted linear effects into a Workbench: the model or the measuring chain has it from
    here on, nuisances are those beside it.

    linear_stage: whether the lowest record tells of the linear structure with them; looked for
    where it is None.
    """
    candidate = candidate_named(prepared.adopted["name"])
    physical = candidate.physical(prepared.adopted["unit"], prepared.scales)
    values = candidate.variant(bench.values, physical)
    if values is not bench.values:
        bench.rebase(values)
    if linear_stage is not None:
        bench.linear_stage = linear_stage
    if prepared.fit is not None:
        bench.measured_fit = ModalFit(
            **{name: np.array(value) for name, value in prepared.fit.items()}
        )
    bench.measuring = candidate.measuring(physical, bench.signals.names)
    bench.nuisance = corrected_nuisance(bench)[0] if bench.linear_stage else None


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


def read_lowest(bench, fresh, out):
    """Return the Workbench with what the lowest record tells: linear stage, delays, linear effects,
    what is adopted; Prepared out is changed.

    bench: Workbench; fresh() gives another one.
    """
    driven, begun, tables = driven_channels(bench), (), {}
    if (
        left(bench.measured_fit, bench.bare) > priors.LINEAR_RESIDUAL
    ):  # modes that moved too far to be followed: begin from the effects that come nearest
        bench.measured_fit, begun = fit_from_nearest(
            bench, LinearChanges(bench), out.scales, held(bench.campaign)
        )
        bench.__dict__.pop("measured_reading", None)
    fit = bench.measured_fit
    if np.median(fit.share[driven]) > priors.UNREAD:
        out.linear_stage = False
        out.checks.append(
            {
                "check": "lowest level",
                "level": "warn",
                "record": None,
                "channel": None,
                "message": UNREAD_MESSAGE,
            }
        )
        return bench
    _, _, out.chi_square, _ = corrected_nuisance(bench)
    out.residual = fit.residual.tolist()
    out.nonlinear_low = bool(fit.residual[driven].max() > priors.LINEAR_RESIDUAL)
    told = read_driven(bench, fresh, out, begun)
    bench = read_all(bench, fresh, out, tables, begun) if told is None else told
    # of the last fit: where modes moved far, the first one is late by what it misses
    fit = bench.measured_fit or fit
    out.delays = {
        name: float(lag)
        for name, lag in zip(bench.signals.names, fit.delay, strict=True)
        if lag != 0.0
    }
    for name, lag in out.delays.items():
        out.checks.append(
            {
                "check": "delay",
                "level": "warn",
                "record": None,
                "channel": name,
                "message": (
                    f"{name} reads {1e3 * lag:+.3f} ms late against the model's response to the"
                    " force; what is simulated is made as late."
                ),
            }
        )
    acting = acting_place(bench) if bench.measured_fit is not None else None
    if acting is not None:
        out.scales |= searched((acting.low_m, acting.high_m))
    out.checks += linear_findings(bench, fresh, out.adopted, out.nonlinear_low, acting)
    out.fit = (
        {name: np.asarray(value).tolist() for name, value in asdict(bench.measured_fit).items()}
        if bench.measured_fit is not None
        else None
    )
    return bench


def read_driven(bench, fresh, out, begun):
    """Return the Workbench with the linear effect that those modes tell which the force drives in
    the model, where all that the record shows fits with it; Prepared out is changed. None where it
    does not, and where the force drives all that were read.

    Where modes moved far, one that is not driven is fitted to what the others leave: it stayed at
    276 Hz, known to a ten-thousandth, and no effect of the model was let move the others as far.
    """
    driven = driven_modes(bench.bare, bench.measured_fit.modes)
    if driven.all() or not driven.any():
        return None
    alone = fresh()
    alone.measured_fit = bench.measured_fit.of_modes(driven)
    rows = linear_rows(alone, out.scales, {}, begun)
    if not nameable(rows[0], out.scales) or not told_apart(rows):
        return None
    known, out.adopted = out.adopted, rows[0]
    moved = fresh()
    moved.measured_fit = alone.measured_fit
    adopt(moved, out)
    fits = moved.linear_stage and moved.measured_fit is not alone.measured_fit
    if not fits or LinearMisfit(moved, len(rows[0]["unit"]), alone.bare).p() < priors.SIGNIFICANT:
        out.adopted = known
        return None
    out.linear, out.nonlinear_low = rows, False
    return read_again(moved, fresh, out, {}, begun, driven_alone=True)


def told_apart(rows):
    """Return whether the best single effect of rows of linear_rows is told from the others: a force
    that is turned drives its modes as one with another gain does.
    """
    singles = [row for row in rows if "+" not in row["name"]]
    first = candidate_named(singles[0]["name"]).ids
    others = [row["gain"] for row in singles if candidate_named(row["name"]).ids != first]
    return singles[0]["gain"] > max(others, default=-np.inf) + priors.LINEAR_AMBIGUOUS


def read_all(bench, fresh, out, tables, begun):
    """Return the Workbench with the linear effects that all modes tell which the lowest record
    shows; Prepared out is changed.
    """
    driven, fit = driven_channels(bench), bench.measured_fit
    out.linear = linear_rows(bench, out.scales, tables, begun)
    singles, leaves = [row for row in out.linear if "+" not in row["name"]], []
    for row in (*singles[:1], *(row for row in out.linear[:1] if row not in singles)):
        if not nameable(row, out.scales):
            continue
        out.adopted, bench = row, fresh()
        bench.measured_fit = fit
        adopt(bench, out)
        # modes that moved far are fitted well only from the model that moved them: what is left
        # there tells whether the structure is linear
        rest = bench.measured_fit.residual[driven].max() if bench.linear_stage else np.inf
        if rest < priors.LINEAR_RESIDUAL:
            out.nonlinear_low = False
            bench = read_again(bench, fresh, out, tables, begun)
            break
        leaves.append((rest, row, bench))
    else:  # the modes were read without it: one effect, unless two leave less
        if leaves:
            _, out.adopted, bench = min(leaves, key=lambda one: one[0])
    if out.nonlinear_low:
        out.adopted, bench = None, fresh()
        bench.measured_fit = fit
    return bench


UNREAD_MESSAGE = (
    "No modes explain the lowest record: it touches already, or the structure is another one."
    " Linear effects are tried by simulation, beside the others. A record at a lower load would"
    " tell them by itself."
)


def read_again(moved, fresh, out, tables, begun, driven_alone=False):
    """Return the Workbench with what the lowest record tells once its modes are fitted from the
    model that moved them; Prepared out is changed.

    moved: Workbench with effects adopted; fresh() gives another one, whose own fit may be percents
    off where a mode moved far: half a kilogram was read as 3 % more, and a second effect made of
    the difference. Where that tells of other effects, once more. driven_alone: by the modes alone
    that the force drives, see read_driven.
    """
    for _ in range(AGAIN):
        if (
            moved.values is moved.given or moved.measured_fit is None
        ):  # a fault of the chain moves no mode
            return moved
        bare, before = fresh(), candidate_named(out.adopted["name"]).ids
        fit = moved.measured_fit
        if driven_alone:
            fit = fit.of_modes(driven_modes(moved.bare, fit.modes))
        bare.measured_fit = translated(fit, moved.bare, bare.bare)
        rows = linear_rows(bare, out.scales, tables, begun)
        if not nameable(rows[0], out.scales):
            return moved
        out.linear, out.adopted = rows, rows[0]
        if candidate_named(rows[0]["name"]).ids == before:
            break
        moved = fresh()  # fitted anew from the model that holds what is adopted now
        adopt(moved, out)
    adopt(bare, out)
    return bare


AGAIN = 3  # times at most


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
