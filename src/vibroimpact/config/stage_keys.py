"""The keys of the configuration that each stage of the workflow uses.

The rules put stage_params into `params:`, and a stage reads nothing else of the configuration (see
StageSettings). A changed key therefore reruns just the stages that use it, and no stage can use a
key that it does not declare.
"""

from collections.abc import Mapping
from typing import Any

from vibroimpact.io.provenance import config_digest

from .schema import Config

# Keys of the reduced model, of a run with it, of a study's simulation, and of spectra.
MODEL = (
    *("structure", "damping", "supports", "elements", "masses", "mode_frequency_factors"),
    *("initial", "points", "excitation", "flow.acting_m_per_s", "flow.density_kg_per_m3"),
    *("flow.direction", "flow.both_directions", "flow.stretches", "flow.coupling"),
    *("basis", "record.sensors", "record.shape_line"),
)
RUN = (
    *("study", "seed", "structure.section", "excitation", "integration", "grid.gap_m"),
    *("record.duration_s", "record.sampling_frequency_Hz", "record.stress_limit_Pa"),
    "record.every_step",
)
SIMULATION = (*RUN, "grid.seeds")
SPECTRA = ("spectra", "identification.lscf", "identification.broadband")
RESPONSE = ("structure.section", "excitation", "grid.gap_m", "spectra", "identification")

STAGE_KEYS: dict[str, tuple[str, ...]] = {
    "targets": (
        *("study", "grid", "identification", "record.every_step", "record.keep_time_series"),
        *("overlay.load_rms_N", "overlay.campaign"),
    ),
    "basis": MODEL,
    "simulate": SIMULATION,
    "simulate_to_spectra": (*SIMULATION, *SPECTRA),
    "statistics": ("study",),
    "spectra": ("study", "excitation", "record.sampling_frequency_Hz", *SPECTRA),
    "identify": ("structure.section", "excitation", "identification"),
    "consistency": ("study", "grid", "identification"),
    "synthetic_campaign": (*RUN, "points", "overlay.gap_ratio", "overlay.noise", "overlay.seed"),
    "figures_model": (*MODEL, "grid.gap_m"),
    "figures_response": RESPONSE,
    "figures_identification": (*RESPONSE, "record.shape_line"),
    "figures_checks": (
        *("structure.section", "integration.imperfection", "integration.scheme"),
        *("integration.steps_per_second", "record.stress_limit_Pa"),
        "identification.stiffness_range_N_per_m",
    ),
    "supports_prediction": ("excitation", "identification"),
    "timing": ("study",),
    "study_page": tuple(Config.model_fields),
    "validation": tuple(Config.model_fields),
}


# The keys that the numbers of a case depend on, and the tables that gather them.
ANSWER_STAGES = ("basis", "simulate_to_spectra", "spectra", "identify", "consistency")


def answer_digest(values: Mapping[str, Any]) -> str:
    """Return the digest of all keys that the tables of a study depend on.

    values: nested, of a checked configuration in plain values.
    """
    keys = {key for stage in ANSWER_STAGES for key in STAGE_KEYS[stage]}
    return config_digest(select(values, tuple(sorted(keys))))


def stage_params(config: Config, stage: str) -> dict[str, Any]:
    """Return {dotted key: value} of the keys that a stage uses, in plain values.

    Raises KeyError when the stage is unknown.
    """
    return select(config.model_dump(mode="json"), STAGE_KEYS[stage])


def select(values: Mapping[str, Any], keys: tuple[str, ...]) -> dict[str, Any]:
    """Return {dotted key: value} of nested values."""
    return {key: _value_at(values, key.split(".")) for key in keys}


def _value_at(values: Any, parts: list[str]) -> Any:
    """Return the value at a dotted key, None inside a section that is left out or of a kind without
    the key.
    """
    for part in parts:
        if values is None or ("kind" in values and part not in values):
            return None
        values = values[part]
    return values
