"""Corrected modes in a configuration, and the text in place of one that is no better."""

from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.config.reading import check_config
from vibroimpact.effects.effect import Values
from vibroimpact.effects.registry import effects_in_words
from vibroimpact.linear_stage.nuisance import Nuisance
from vibroimpact.observation.attached_model import attach
from vibroimpact.reduction.structural_modifications import with_frequency_factors

from .misfit import makes_worse


def not_offered(withdrawn: dict[str, Any]) -> str:
    """Return the text in place of a completed configuration that is no better than the given one.

    withdrawn: verdict.content.Withdrawn in plain values.
    """
    effects = effects_in_words(row["id"] for row in withdrawn["effects"])
    splits = {
        "the records that took no part": withdrawn["misfit"]["holdout"],
        "the records that it was fitted to, run anew,": withdrawn["misfit"]["fit"],
    }
    known = {name: row for name, row in splits.items() if row["before_dB"] is not None}
    farther = {name: row for name, row in known.items() if makes_worse(row)}
    records, misfit = next(iter((farther or known).items()))
    return (
        f"# No model is offered: {effects} was added, and {records} are\n"
        f"# {'farther off' if farther else 'hardly nearer'} with it,"
        f" {misfit['before_dB']:.2f} dB before and {misfit['after_dB']:.2f} dB after.\n"
    )


def computed_modes(values: Values, campaign: xr.Dataset) -> np.ndarray:
    """Return (mode,): the index of each mode among the modes without frequency factors.

    values: configuration in plain values. Factors may change the order of the modes.
    """
    computed = attach(check_config(values | {"mode_frequency_factors": []}, "model"), campaign)
    return with_frequency_factors(computed.omega, values["mode_frequency_factors"])[1]


def with_nuisance(values: Values, nuisance: Nuisance, computed: np.ndarray) -> Values:
    """Return the configuration in plain values with corrected frequencies and damping ratios.

    computed (mode,): indices of the corrected modes as computed_modes gives them.
    """
    count = int(nuisance.modes.max(initial=-1)) + 1
    factors = [
        *values["mode_frequency_factors"],
        *[1.0]
        * max(0, int(np.max(computed, initial=-1)) + 1 - len(values["mode_frequency_factors"])),
    ]
    for mode, factor in zip(computed, nuisance.frequency, strict=True):
        factors[mode] *= float(factor)
    damping = dict(values["damping"])
    if damping["kind"] == "modal":
        ratios = [
            *damping["first_ratios"],
            *[damping["other_ratio"]] * max(0, count - len(damping["first_ratios"])),
        ]
        for mode, factor in zip(nuisance.modes, nuisance.damping, strict=True):
            ratios[mode] *= float(factor)
        damping["first_ratios"] = ratios
    return values | {"mode_frequency_factors": factors, "damping": damping}
