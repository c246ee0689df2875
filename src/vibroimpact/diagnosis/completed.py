"""The completed model as a configuration, and the rows of its effects."""

from itertools import zip_longest
from typing import Any

import numpy as np
import yaml

from vibroimpact.diagnosis.verdict.content import NINETY_SD
from vibroimpact.effects.effect import Values
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.decimation import RATIO
from vibroimpact.integration.step_stability import require_stable_step
from vibroimpact.io.records import plain_values

from .constants import GAIN_SD, VALUE_SD
from .explanations import Point, Structure
from .measurement.signals import Signals
from .search import Hypothesis


def effect_rows(hypothesis: Hypothesis, signals: Signals) -> list[Values]:
    """Return the rows of `effects` of verdict.json: id, family, location, parameters with their 90
    % intervals: of the fit, and of the difference between two codes of the same structure.
    """
    fit = hypothesis.fit
    half = NINETY_SD * fit.deviation
    out = []
    for number, term in enumerate(hypothesis.point.terms):
        parameters: dict[str, dict[str, Any]] = {}
        for row, x, reach in zip(fit.rows, fit.x, half, strict=True):
            if row.kind == "term" and row.index == number:
                parameter = term.effect.parameters[row.parameter]
                low, high = (
                    row.to_value(float(np.clip(end, row.low, row.high)))
                    for end in (x - reach, x + reach)
                )
                value = term.values[row.parameter]
                change = row.to_value(x) * (x if row.log else 1.0)  # from no effect
                # a gain common to force and responses is hidden in every length
                hidden = NINETY_SD * float(
                    np.hypot(GAIN_SD * parameter.gain_power * value, VALUE_SD * change)
                )
                parameters[parameter.name] = {
                    "value": value,
                    "low": value - float(np.hypot(value - low, hidden)),
                    "high": value + float(np.hypot(high - value, hidden)),
                    "unit": parameter.unit,
                }
        if term.effect_id == "gap" and np.isfinite(signals.gap).any():
            nominal = float(np.nanmax(signals.gap))
            parameters["gap"] = {"unit": "m"} | {
                key: nominal * parameters["gap_factor"][key] for key in ("value", "low", "high")
            }
        out.append(
            {
                "id": term.effect.reported,
                "family": term.effect.family,
                "location": term.location,
                "parameters": parameters,
            }
        )
    return out


def completed_model(structure: Structure, point: Point, what: str) -> str:
    """Return the YAML text of the configuration of a Point, its frequencies and damping corrected.

    what: the first line, a comment. Gains are a comment: they are not part of the model.
    """
    config = structure.configuration(structure.terms(point))
    values = config.model_dump(mode="json")
    factors = np.exp(point.frequency)
    known = zip_longest(values["mode_frequency_factors"], factors, fillvalue=1.0)
    values["mode_frequency_factors"] = [float(own * factor) for own, factor in known]
    damping = dict(values["damping"])
    if damping["kind"] == "modal" and point.damping:
        ratios = [*damping["first_ratios"], *[damping["other_ratio"]] * len(point.damping)]
        damping["first_ratios"] = [
            float(ratio * np.exp(own)) for ratio, own in zip(ratios, point.damping, strict=False)
        ] + [float(ratio) for ratio in damping["first_ratios"][len(point.damping) :]]
    gains = zip_longest(structure.names, np.exp(point.gain), fillvalue=1.0)
    told = ", ".join(f"{name} {gain:.4f}" for name, gain in gains)
    values |= {"damping": damping, "study": f"{values['study']}_updated"}
    values["integration"] |= _integration(structure, point)
    return "\n".join(
        [
            f"# {what}",
            f"# Gains of the channels, measured over true: {told}",
            yaml.safe_dump(plain_values(values), sort_keys=False, width=140),
        ]
    )


def _integration(structure: Structure, point: Point) -> Values:
    """Return the keys of `integration` that change: none, or Newmark's scheme with the steps that
    the free modes need, if the exact step would make a damped contact grow.
    """
    config = structure.config
    own = config.integration
    try:
        require_stable_step(structure.model(point), own.steps_per_second, own.scheme)
    except IntegrationError:
        tick = RATIO * config.record.sampling_frequency_Hz
        needed = 2.0 * np.pi * config.basis.free_modes_to_Hz
        steps = tick * int(np.ceil(max(needed, own.steps_per_second) / tick))
        return {"scheme": "newmark", "steps_per_second": steps}
    return {}
