"""The equivalent support of a configuration without a simulation: an estimate, from a law."""

from pathlib import Path

import numpy as np

from vibroimpact.config.reading import config_of
from vibroimpact.config.schema import Config
from vibroimpact.identify.linear.support_groups import driven_word
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.reduction.reduced_model import build_model

from .answer import Answer, EquivalentError, GroupAnswer, Span
from .displacement_law import ShippedLaw, held_tube, shipped_law
from .homogeneity import effects_with_a_scale
from .missing_case import require_metres


def estimate_equivalent(config: Config | str | Path, load_rms_N: float, gap_m: float) -> Answer:
    """Return the Answer that the law of the default study estimates, without a simulation.

    The law was compared with simulations of other tubes. The values are the law times the median
    ratio found there; at least 80 % of the ratios are inside the interval. All supports have the
    same k and c.

    config: a Config, or the path of a file.
    load_rms_N: RMS of the force in N. gap_m: radial gap in m.

    Raises EquivalentError for a configuration or a level that the law was not made for.
    """
    config = config_of(config)
    require_metres(gap_m, config.grid.gap_m)
    model = build_model(config, motion_only=True)
    shipped = shipped_law()
    if config.excitation.kind != "band_limited":
        raise EquivalentError(
            f"excitation.kind is {config.excitation.kind}: the law knows band_limited forces alone."
            " Run the study"
        )
    if not len(model.support_of_point):
        raise EquivalentError("the configuration has no supports: there is nothing to estimate")
    if effects := effects_with_a_scale(model):
        raise EquivalentError(
            f"the model has {'; '.join(effects)}, which the law does not know: run the study"
        )
    tube = held_tube(model, config.excitation.band_Hz)
    if not np.all(np.isfinite(tube.motion)):
        raise EquivalentError(
            "a mode of the structure is overdamped: the law knows vibration alone. Run the study"
        )
    gap = gap_m * float(np.mean(model.gap_factor))
    level = tube.level(load_rms_N, gap)
    _require_inside(shipped, level, load_rms_N)
    k, c = shipped.law.at(tube, load_rms_N, gap)
    error = shipped.error_at(level)
    group = GroupAnswer(
        group="all",
        supports=model.support_names,
        direction=driven_word(model),
        k=Span(*(k * error[name] for name in ("k_median", "k_low", "k_high"))),
        c=Span(*(c * error[name] for name in ("c_median", "c_low", "c_high"))),
        how=(
            f"from a law: without supports the tube would move {level:.3g} gaps RMS at its plates;"
            f" on the equivalent support, {tube.held(k, load_rms_N, gap):.3g}"
        ),
    )
    return Answer(
        config.study, "estimate", load_rms_N, gap_m, (group,), True, _notes(model, shipped, error)
    )


def _require_inside(shipped: ShippedLaw, level: float, load_rms_N: float) -> None:
    """Raise EquivalentError for a level that the law was not fitted at."""
    law = shipped.law
    if law.inside(level):
        return
    low, high = (load_rms_N / level * end for end in (law.level[0], law.level[-1]))
    below = level < law.level[0]
    hint = "below, the tube hardly touches its supports" if below else "run the study"
    raise EquivalentError(
        f"without supports the tube would move {level:.3g} gaps RMS at its plates; the law was"
        f" fitted from {law.level[0]:.3g} to {law.level[-1]:.3g}, here {low:.3g} to {high:.3g} N"
        f" RMS at this gap. Nothing is extrapolated: {hint}"
    )


def _notes(model: ModalModel, shipped: ShippedLaw, error: dict[str, float]) -> tuple[str, ...]:
    """Return the remarks on the estimate."""
    every = shipped.errors[-1]
    notes = [
        "This is an estimate from a law, not a result: run the study for one. The law was compared"
        f" with simulations of {every['tubes']:g} other tubes, {every['cases']:g} cases. At this"
        f" level simulation over law is {error['k_low']:.2g} to {error['k_high']:.2g} for k and"
        f" {error['c_low']:.2g} to {error['c_high']:.2g} for c in at least 80 % of them: the"
        f" intervals above. The values are the law times the medians, {error['k_median']:.2g} and"
        f" {error['c_median']:.2g}."
    ]
    laws = model.contact_laws
    unknown = [
        name
        for name, there in (
            ("contact damping", np.any(laws.damping != 0.0)),
            ("friction", np.any(laws.friction != 0.0)),
            ("flat stops", len(laws.land_point) > 0),
            ("unequal gaps", float(np.ptp(model.gap_factor)) > 0.0),
        )
        if there
    ]
    if unknown:
        notes.append(
            f"The law was fitted and measured without {', '.join(unknown)}, which this model has:"
            " the intervals do not cover them."
        )
    return tuple(notes)
