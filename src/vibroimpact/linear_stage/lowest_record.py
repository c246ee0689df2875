"""Main step of the linear stage: modes, delays and linear effects identified from the lowest record
alone, and where another force acts in it.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.verdict.content import OTHER_STRUCTURE

from . import priors
from .acting_place import acting_place
from .adopted import adopt
from .candidates import candidate_named
from .driven_channels import driven_channels
from .effect_fit import LinearChanges
from .effect_pairs import Begun
from .effect_readings import LinearTable
from .effect_table import held, linear_rows, nameable
from .findings import linear_findings
from .goodness_of_fit import LinearMisfit
from .lags import driven_modes
from .mode_identification import left
from .nearest_model import fit_from_nearest, translated
from .prepared import Prepared
from .scales import searched
from .share_explained import share_explained
from .workbench import Workbench, corrected_nuisance


def read_lowest(bench: Workbench, fresh: Callable[[], Workbench], out: Prepared) -> Workbench:
    """Return the Workbench with the linear effects that the lowest record identifies; Prepared out
    is changed: linear stage, delays, linear effects, what is adopted.

    fresh() gives a Workbench with nothing adopted.
    """
    driven = driven_channels(bench)
    begun: Begun = ()
    tables: dict[str, LinearTable] = {}
    # modes shifted too far from the model's: begin the fit from the effects whose spectra come
    # nearest
    if left(bench.measured_fit, bench.bare) > priors.LINEAR_RESIDUAL:
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
    identified = read_driven(bench, fresh, out, begun)
    effect_leads = False
    if identified is None:
        bench, effect_leads = read_all(bench, fresh, out, tables, begun)
    else:
        bench = identified
    out.other_structure = out.adopted is not None and structure_says_as_much(
        bench, fresh, out.adopted
    )
    if out.adopted is not None and (
        out.other_structure or not adopted_explains(bench, fresh, out.adopted)
    ):
        bench, out.adopted, out.nonlinear_low = fresh(), None, True
        bench.measured_fit = fit
    if out.adopted is None and not effect_leads:
        out.other_structure = out.other_structure or is_of_another_structure(bench)
    if out.other_structure:
        out.nonlinear_low = False
        out.checks.append(check_row(OTHER_STRUCTURE, "warn", OTHER_MESSAGE))
    # of the last fit: where modes shifted far, misfit of the first one appears as delay
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


def read_driven(
    bench: Workbench, fresh: Callable[[], Workbench], out: Prepared, begun: Begun
) -> Workbench | None:
    """Return the Workbench with the linear effect identified from the modes that the force drives
    in the model alone, where the whole record fits with it; Prepared out is changed. None where it
    does not fit, and where the force drives all modes that were fitted.

    Where modes shifted far, a mode that is not driven is fitted to the residual of the others. One
    such stayed at 276 Hz with a scatter of 1e-4, so that no effect could shift the others enough.
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


def told_apart(rows: Sequence[dict[str, Any]]) -> bool:
    """Return whether the best single effect of rows of linear_rows is distinguished from the
    others: a force in another direction drives its modes as one of another gain does.
    """
    singles = [row for row in rows if "+" not in row["name"]]
    first = candidate_named(singles[0]["name"]).ids
    others = [row["gain"] for row in singles if candidate_named(row["name"]).ids != first]
    return singles[0]["gain"] > max(others, default=-np.inf) + priors.LINEAR_AMBIGUOUS


def read_all(
    bench: Workbench,
    fresh: Callable[[], Workbench],
    out: Prepared,
    tables: dict[str, LinearTable],
    begun: Begun,
) -> tuple[Workbench, bool]:
    """Return (Workbench with the linear effects identified from all modes that the lowest record
    shows, whether one that is not adopted explains it, and better than another structure does);
    Prepared out is changed. Beside contact at that load an effect explains a record and does not
    leave it linear.
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
        # modes that shifted far are fitted well only from the model with the effect: the residual
        # of that fit shows whether the structure is linear
        rest = bench.measured_fit.residual[driven].max() if bench.linear_stage else np.inf
        if rest < priors.LINEAR_RESIDUAL:
            out.nonlinear_low = False
            bench = read_again(bench, fresh, out, tables, begun)
            break
        leaves.append((rest, row, bench))
    else:  # no residual is small: prefer effects that explain the record, then the least residual
        if leaves:
            leaves.sort(key=lambda one: (not adopted_explains(one[2], fresh, one[1]), one[0]))
            _, out.adopted, bench = leaves[0]
    effect_leads = False
    if out.nonlinear_low:
        effect_leads = (
            out.adopted is not None
            and adopted_explains(bench, fresh, out.adopted)
            and not structure_says_as_much(bench, fresh, out.adopted)
        )
        out.adopted, bench = None, fresh()
        bench.measured_fit = fit
    return bench, effect_leads


def adopted_explains(
    bench: Workbench, fresh: Callable[[], Workbench], adopted: dict[str, Any]
) -> bool:
    """Return whether what was adopted (a row of linear_rows) explains the lowest record, or most of
    the misfit beyond chance, when the modes are fitted again with it in the model of a Workbench. A
    structure that touches already differs from every linear one, but some of these come nearer.

    fresh() gives a Workbench without it.
    """
    if not bench.linear_stage:  # the model touches with it, which is no evidence against it
        return True
    before, after = misfits(bench, fresh, adopted)
    share = share_explained(after.chi_square, before.chi_square, after.count)
    return after.p() > priors.SIGNIFICANT or share > priors.EXPLAINED


def misfits(
    bench: Workbench, fresh: Callable[[], Workbench], adopted: dict[str, Any]
) -> tuple[LinearMisfit, LinearMisfit]:
    """Return the LinearMisfits without and with what was adopted (a row of linear_rows), of the
    modes fitted with it in the model of a Workbench. fresh() gives a Workbench without it.
    """
    given = fresh()
    given.measured_fit = translated(bench.measured_fit, bench.bare, given.bare)
    return LinearMisfit(given), LinearMisfit(bench, len(adopted["unit"]), given.bare)


def suffices(bench: Workbench, fresh: Callable[[], Workbench], adopted: dict[str, Any]) -> bool:
    """Return whether one effect that was adopted leaves no more than chance of the lowest record:
    a second has nothing to explain. Arguments as in misfits.
    """
    return "+" not in adopted["name"] and misfits(bench, fresh, adopted)[1].p() > priors.SIGNIFICANT


def is_of_another_structure(bench: Workbench) -> bool:
    """Return whether another length, section or factor of all frequencies takes most of the misfit
    beyond chance from the lowest record: its response is linear then, and the model is not its own.
    """
    if len(bench.measured_fit.modes) < TELLING_MODES:
        return False
    found = LinearMisfit(bench)
    return found.p() < priors.SIGNIFICANT and any(
        share_explained(mend.chi_square, found.chi_square, found.count) > priors.EXPLAINED
        for mend in found.of_structure
        if abs(mend.shift) > SHIFTED
    )


TELLING_MODES = 3  # of fewer, a factor explains any shift
# a section of another mass and stiffness that leaves all frequencies as they are is another force
SHIFTED = priors.NAMED_BEYOND * priors.FREQUENCY_SD


def structure_says_as_much(
    bench: Workbench, fresh: Callable[[], Workbench], adopted: dict[str, Any]
) -> bool:
    """Return whether another length or section, one cause, leaves no more of the lowest record than
    two effects that were adopted, or than one that leaves more than chance. Arguments as in
    misfits.

    A fluid beside a gain of the force shifts all modes and scales all responses as another section
    does.
    """
    if not bench.linear_stage:
        return False
    before, after = misfits(bench, fresh, adopted)
    if "+" not in adopted["name"] and after.p() > priors.SIGNIFICANT:
        return False
    return min(mend.chi_square for mend in before.of_structure) <= after.chi_square


OTHER_MESSAGE = (
    "No effect explains the lowest record, another length or section does: nothing was looked for"
    " beside this model. Mend it first."
)
UNREAD_MESSAGE = (
    "No modes explain the lowest record: it touches already, or the structure is another one."
    " Linear effects are tried by simulation, beside the others. A record at a lower load would"
    " tell them by itself."
)


def read_again(
    moved: Workbench,
    fresh: Callable[[], Workbench],
    out: Prepared,
    tables: dict[str, LinearTable],
    begun: Begun,
    driven_alone: bool = False,
) -> Workbench:
    """Return the Workbench with the linear effects identified again from modes that are fitted from
    the model with the adopted effects, at most AGAIN times until they are the same; Prepared out is
    changed.

    moved: Workbench with effects adopted; fresh() gives one without them, whose own fit may be
    percents off where a mode shifted far: half a kilogram was found 3 % too large, and a second
    effect made up the difference. driven_alone: from the modes alone that the force drives, see
    read_driven.
    """
    assert out.adopted is not None, "there is an adopted effect"
    for _ in range(AGAIN):
        # a fault of the measuring chain shifts no mode
        if moved.values is moved.given or moved.measured_fit is None:
            return moved
        bare, before = fresh(), candidate_named(out.adopted["name"]).ids
        fit = moved.measured_fit
        if driven_alone:
            fit = fit.of_modes(driven_modes(moved.bare, fit.modes))
        bare.measured_fit = translated(fit, moved.bare, bare.bare)
        alone = suffices(moved, fresh, out.adopted)
        rows = linear_rows(bare, out.scales, tables, begun, pairs=not alone)
        if not nameable(rows[0], out.scales):
            return moved
        out.linear, out.adopted = rows, rows[0]
        if candidate_named(rows[0]["name"]).ids == before:
            break
        moved = fresh()  # fitted again from the model with what is adopted now
        adopt(moved, out)
    adopt(bare, out)
    return bare


AGAIN = 3  # times at most
