"""Findings on the lowest record that no effect of the catalogue explains, as rows of checks: a
linear model that does not fit and where to look first, other sources, and drift.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from vibroimpact.campaign.checks.stated import check_row

from . import priors
from .acting_place import ActingPlace
from .drift import drift_of
from .goodness_of_fit import LinearMisfit, Mend
from .nearest_model import translated
from .other_source import other_sources
from .workbench import Workbench

# What may be wrong with a model or a campaign file and is no effect of the catalogue.
NO_EFFECT = ("frequencies", "section", "length", "place", "direction")
SHOWN = 3  # changes of those that fit equally well

Rows = list[dict[str, Any]]


def linear_findings(
    bench: Workbench,
    fresh: Callable[[], Workbench],
    adopted: dict[str, Any] | None,
    bent: bool,
    acting: ActingPlace | None = None,
) -> Rows:
    """Return rows of checks on the lowest record of a Workbench with what was adopted.

    fresh() gives a Workbench without it; adopted: row of linear_rows, None for nothing; bent:
    whether the response is nonlinear in the record; acting: see source_rows.
    """
    given = bench
    if adopted is not None:
        given = fresh()
        given.measured_fit = translated(bench.measured_fit, bench.bare, given.bare)
    record = bench.signals.record_names[bench.signals.lowest]
    if bent:
        return bent_row(given, record) or source_rows(bench, record, acting)
    return (
        misfit_row(bench, given, adopted, record)
        + source_rows(bench, record, acting)
        + drift_rows(bench, record)
    )


def misfit_row(
    bench: Workbench, given: Workbench, adopted: dict[str, Any] | None, record: str
) -> Rows:
    """Return [row]: whether the linear model fits the record, and where to look first if not.

    bench, given: Workbenches with and without what was adopted (a row of linear_rows, or None);
    record: its name.
    """
    before = LinearMisfit(given)
    if adopted is None:
        return [_fits(before, record) if _chance(before) else _does_not(before, [before], record)]
    freed = len(adopted["unit"])
    after = LinearMisfit(bench, freed, given.bare)
    if not _chance(after):
        return [_does_not(after, [before, after], record, adopted["name"])]
    if _chance(before):
        return [_fits(after, record)]
    score = after.chi_square + 2.0 * priors.PARAMETER_COST * freed
    alike = [
        mend
        for mend in _as_good(before, before.mends[0])
        if mend.kind in NO_EFFECT
        and mend.score < score + 2.0 * priors.LINEAR_AMBIGUOUS
        and before.p(mend.chi_square, mend.freed) > priors.SIGNIFICANT
    ]
    if not alike:
        return [_fits(after, record)]
    return [
        check_row(
            "linear model",
            "warn",
            f"{_words(adopted['name'])} makes the linear model fit record {record}. So would"
            f" {_listed(alike, before)}: rule that out first.",
            record,
        )
    ]


def bent_row(bench: Workbench, record: str) -> Rows:
    """Return [row] where the response in the record only appears nonlinear because one channel is
    at another place than stated, else none.
    """
    misfit = LinearMisfit(bench)
    mends = [
        mend
        for mend in misfit.places
        if misfit.p(mend.chi_square, mend.freed) > priors.SIGNIFICANT
        and mend.left is not None
        and mend.left < priors.LINEAR_RESIDUAL
    ]
    if not mends:
        return []
    return [
        check_row(
            "linear model",
            "warn",
            f"The linear model does not fit record {record}: first look at"
            f" {text_of(mends[0], misfit)}. There the record is that of the model.",
            record,
            mends[0].which,
        )
    ]


def source_rows(bench: Workbench, record: str, acting: ActingPlace | None = None) -> Rows:
    """Return [row]: whether the record is a linear response to the measured force. acting: the
    ActingPlace of another force, None where it is not known.
    """
    found, signals = other_sources(bench), bench.signals
    force = str(bench.campaign["force_channel_name"].values[0])
    if not found:
        return [
            check_row(
                "other source",
                "pass",
                f"Noise explains what is no linear response to {force} in record {record}.",
                record,
            )
        ]
    first = found[0]
    others = sorted(
        {signals.names[row.channel] for row in found[1:]} - {signals.names[first.channel]}
    )
    beside = f" ({', '.join(others)} as well)" if others else ""
    return [
        check_row(
            "other source",
            "warn",
            f"{first.share:.1%} of the power of {signals.names[first.channel]} between"
            f" {first.band_Hz[0]:.3g} and {first.band_Hz[1]:.3g} Hz at"
            f" {signals.load[signals.lowest]:.3g} {signals.load_unit} is no linear response to"
            f" {force},"
            f" {first.factor:.0f} times what noise explains{beside}: something else"
            f" drives the structure, or it is not linear at this load.{_acts(acting)}",
            record,
            signals.names[first.channel],
        )
    ]


def _acts(acting):
    """Return a sentence on an ActingPlace, an empty text where it is None."""
    if acting is None:
        return ""
    along = ", ".join(f"{component:+.2f}" for component in acting.direction)
    touched = acting.support
    where = f" (support {touched} is there: it may touch that already)" if touched else ""
    return (
        f" A force between {acting.low_m:.3g} and {acting.high_m:.3g} m along the tube, most likely"
        f" at {acting.arc_length_m:.3g} m in direction ({along}), explains"
        f" {acting.share:.0%} of it{where}."
    )


def drift_rows(bench: Workbench, record: str) -> Rows:
    """Return [row]: whether the modes of the record are the same in its first and last half."""
    drift = drift_of(bench)
    if drift.p > priors.SIGNIFICANT:
        message = f"The modes of record {record} stay where they are while it lasts."
        return [check_row("drift", "pass", message, record)]
    most = int(np.argmax(np.abs(drift.change / drift.sd)))
    return [
        check_row(
            "drift",
            "warn",
            f"The mode at {drift.frequency_Hz[most]:.4g} Hz moves by"
            f" {100.0 * np.expm1(drift.change[most]):+.2f} % from the first to the last half of"
            f" record {record} (z = {drift.change[most] / drift.sd[most]:.1f}): temperature, water"
            " or a joint changes, and records taken at other times may differ by more.",
            record,
        )
    ]


def text_of(mend: Mend, misfit: LinearMisfit) -> str:
    """Return a Mend of a LinearMisfit in words, to follow "first look at"."""
    return TEXTS[mend.kind](mend, misfit)


def _chance(misfit):
    return misfit.p() > priors.SIGNIFICANT


def _fits(misfit, record):
    return check_row(
        "linear model",
        "pass",
        f"The linear model fits the modes of record {record} (chi-square"
        f" {misfit.chi_square:.0f} for {misfit.count} values).",
        record,
    )


def _does_not(misfit, bases, record, adopted=None):
    """Return the row of a LinearMisfit beyond chance; bases: the LinearMisfits whose Mends are
    considered, that of the given model first.
    """
    beside, first = "", bases[0].mends[0]
    base = bases[0]
    for one in bases:  # with what was adopted only where nothing mends the model as given
        best = one.mends[0]
        if one.p(best.chi_square, best.freed) > priors.SIGNIFICANT:
            base, first = one, best
            beside = f", beside {_words(adopted)}" if one is not bases[0] else ""
            break
    mends = base.p(first.chi_square, first.freed) > priors.SIGNIFICANT
    alike = _as_good(base, first)
    share = _taken(first, base)
    if mends:
        where = f"first look at {_listed(alike, base)}, which mends it{beside}"
        if beside:  # one cause may take most of what these two do
            where += "".join(
                f"; or, without that, at {text}" for text in _of_structure(bases[0], HALF)
            )
    elif share > HALF:
        where = f"first look at {_listed([first], base)}, which takes {share:.0%} of it"
        where += "".join(
            f", or at {text}" for text in _of_structure(base, ABOUT_AS_MUCH * share, first.kind)
        )
    else:
        where = (
            "no length, section, single mode or single channel mends half of it: first look at the"
            " boundary and at what is fixed to the structure"
        )
    tried = f", nor with {_words(adopted)}" if adopted else ""
    return check_row(
        "linear model",
        "warn",
        f"The linear model does not fit record {record}{tried} (chi-square"
        f" {misfit.chi_square:.0f} for {misfit.count} values, by chance in less than 1 % of"
        f" records): {where}. {_most(bases[0])}",
        record,
        first.which if mends and first.kind in ("gain", "direction", "place") else None,
    )


def _of_structure(misfit, least, known=""):
    """Return [text] of the lengths and sections, but for a kind that is known, that take more than
    a share `least` of the chi-square of a LinearMisfit.
    """
    return [
        f"{text_of(mend, misfit)}, {_taken(mend, misfit):.0%}"
        for mend in misfit.of_structure
        if _taken(mend, misfit) > least and mend.kind not in (known, "frequencies")
    ]


HALF = 0.5
ABOUT_AS_MUCH = 0.9  # of the share that the best takes, where neither mends all


def _taken(mend, misfit):
    """Return the share of the chi-square of a LinearMisfit that a Mend takes away."""
    return 1.0 - mend.chi_square / misfit.chi_square


def _as_good(misfit, best):
    """Return the Mends that fit the record as well as the best, without redundant ones: a factor of
    all frequencies includes lengths and sections; arbitrary participations of a channel say least.
    """
    near = [
        mend
        for mend in misfit.mends
        if mend.score < best.score + 2.0 * priors.LINEAR_AMBIGUOUS and mend.kind != "channel"
    ]
    if any(mend.kind == "frequencies" for mend in near):
        near = [mend for mend in near if mend.kind not in ("section", "length")]
    return near or [best]


def _most(misfit):
    """Return a sentence on the differences of all modes and the channel that differs most."""
    moved = misfit.measured.log_frequency - misfit.simulated.log_frequency
    frequencies = np.exp(misfit.measured.log_frequency) / (2.0 * np.pi)
    modes = ", ".join(
        f"{frequency:.4g} Hz ({100.0 * np.expm1(move):+.1f} %)"
        for frequency, move in zip(frequencies, moved, strict=True)
    )
    channel = next(mend.which for mend in misfit.mends if mend.kind == "channel")
    return f"Modes against the model's: {modes}; the shape differs most at {channel}."


def _listed(mends, misfit):
    return ", or at ".join(text_of(mend, misfit) for mend in mends[:SHOWN])


def _words(name):
    """Return a candidate's name in words."""
    return " and ".join(
        part.split("@")[0].replace("_", " ") + " at " + part.split("@")[1]
        for part in name.split("+")
    )


def _percent(log):
    value = 100.0 * np.expm1(log)
    return f"{abs(value):.1f} % {'lower' if value < 0.0 else 'higher'}"


def _frequencies(mend, _):
    return (
        "the length, the section or the material (all frequencies are"
        f" {_percent(mend.amount)} than the model's)"
    )


def _section(mend, _):
    mass, stiffness = mend.amount
    return (
        f"the section or the material ({mass:.2f} times the mass per metre and"
        f" {stiffness:.2f} times the bending stiffness)"
    )


def _length(mend, _):
    return f"the length of the {mend.which} ({mend.amount:.3f} times what is stated)"


def _mode(mend, misfit):
    frequency = np.exp(misfit.measured.log_frequency[mend.which]) / (2.0 * np.pi)
    moved, damping = mend.amount
    return (
        f"the mode at {frequency:.4g} Hz ({_percent(moved)} than the model's,"
        f" {np.exp(damping):.2g} times its damping)"
    )


def _gain(mend, _):
    return (
        f"the gain or the direction of {mend.which} (it reads {mend.amount:.3f} times what the"
        " model gives)"
    )


def _direction(mend, _):
    return (
        f"the direction of {mend.which} (it moves as the model does along"
        f" {np.round(mend.amount, 2).tolist()})"
    )


def _place(mend, misfit):
    return (
        f"the place of {mend.which} (it moves as the model does at"
        f" {(np.round(misfit.place(mend), 3) + 0.0).tolist()} m, {1000.0 * misfit.off_m(mend):.0f}"
        " mm from where it is stated)"
    )


def _channel(mend, _):
    return f"{mend.which} (no place, direction or gain makes it move as the model does)"


TEXTS = {
    "frequencies": _frequencies,
    "section": _section,
    "length": _length,
    "mode": _mode,
    "gain": _gain,
    "direction": _direction,
    "place": _place,
    "channel": _channel,
}
