"""The completed model as a configuration: effects, corrected frequencies and damping of modes."""

import yaml

from vibroimpact.discrepancy.completed_model import computed_modes, with_nuisance
from vibroimpact.linear_stage.prepared import Prepared
from vibroimpact.linear_stage.workbench import Workbench
from vibroimpact.records import plain_values

from .decision import Decision


def updated_model(bench: Workbench, decision: Decision, prepared: Prepared) -> str:
    """Return the YAML text of the completed configuration: effects and corrected modes.

    Gains of channels are a comment, because they are no part of the model.
    """
    values = bench.values
    if decision.chosen is not None:
        values = bench.variant(
            decision.chosen.candidate,
            decision.chosen.candidate.physical(decision.chosen.unit, prepared.scales),
        )
    if bench.nuisance is not None:
        values = with_nuisance(
            values, bench.nuisance, computed_modes(values, bench.campaign)[bench.nuisance.modes]
        )
    what = (
        "The verdict is unknown: nothing was added to what the lowest record told."
        if decision.verdict == "unknown"
        else "The model with what the campaign showed to be missing."
    )
    lines = [f"# {what} Corrections of modes are in mode_frequency_factors and damping."]
    if bench.nuisance is not None:
        gains = ", ".join(
            f"{name} {gain:.4f}"
            for name, gain in zip(bench.signals.names, bench.nuisance.gain, strict=True)
        )
        lines.append(f"# Gains of the channels, measured over true: {gains}")
    values = values | {"study": f"{values['study']}_updated"}
    return "\n".join([*lines, yaml.safe_dump(plain_values(values), sort_keys=False, width=140)])
