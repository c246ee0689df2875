"""Which keys of the configuration each stage of the workflow uses.

The rules put stage_params into `params:` and a stage sees nothing else of the configuration (settings.Settings), so that a changed key
reruns just the stages that use it, and a stage can not come to use a key in secret.
"""

from __future__ import annotations

from typing import Any

from vibroimpact.config_schema import Config

FIGURE_KEYS = tuple(name for name in Config.model_fields if name not in ("seed", "f16_data"))

STAGE_KEYS: dict[str, tuple[str, ...]] = {
    "targets": ("study", "grid", "record.keep_time_series"),
    "basis": ("structure", "damping", "supports", "points", "excitation.point", "excitation.direction", "basis", "record.sensors",
              "record.shape_line"),
    "simulate": ("study", "seed", "excitation", "integration", "grid.gap_m", "grid.seeds", "record.duration_s",
                 "record.sampling_frequency_Hz", "record.stress_limit_Pa"),
    "spectra": ("study", "excitation.direction", "record.sampling_frequency_Hz", "spectra", "identification.lscf",
                "identification.broadband"),
    "identify": ("study", "excitation", "record", "spectra", "identification"),
    "consistency": ("study", "grid", "identification"),
    "figures": FIGURE_KEYS,
    "f16": ("f16_data",),
}


def stage_params(config: Config, stage: str) -> dict[str, Any]:
    """Return {dotted key: value} of the keys that a stage uses, in plain values. Raises KeyError when the stage is unknown."""
    return select(config.model_dump(mode="json"), STAGE_KEYS[stage])


def select(values: dict, keys: tuple[str, ...]) -> dict[str, Any]:
    """Return {dotted key: value} of nested values."""
    return {key: _value_at(values, key.split(".")) for key in keys}


def _value_at(values: Any, parts: list[str]) -> Any:
    """Return the value at a dotted key."""
    for part in parts:
        values = values[part]
    return values
