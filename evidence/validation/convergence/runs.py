"""Response statistics of impacting runs with different steps and numbers of modes, a row per case.

The runs are the study's except for length, sampling frequency (1024 Hz divides all four rates by a
multiple of 5, as the output filter needs) and the varied quantity. The force of a seed has the same
lines at every step, because the synthesis length is the same time at all rates.
"""

import numpy as np

from vibroimpact.config.reading import changed_config
from vibroimpact.identify.spectra.welch import psd_statistics, segment_spectra
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.study.cases import Case
from vibroimpact.study.simulation import simulate_cases

STEP_RATES = (25600, 51200, 102400, 204800)  # steps per second, the paper's scheme
EXACT_RATES = (10240, 20480, 40960)  # steps per second, the exact modal step
MODES_TO_HZ = (2000.0, 4000.0, 7500.0, 12000.0)
NO_MODE_BELOW_HZ = 1.0
MODES_RATE = 102400  # steps per second of runs with different modes; 12 kHz needs more than 75400
LOADS_N = (5.0, 20.0)  # transition, and nearly always in contact
SEEDS = 16
RUN = {
    "record.duration_s": 16.0,
    "record.sampling_frequency_Hz": 1024.0,
    "integration.start_up_s": 4.0,
    "grid.seeds": SEEDS,
}
BANDS_HZ = ((5.0, 20.0), (20.0, 40.0), (40.0, 80.0), (80.0, 200.0), (200.0, 400.0))
SENSORS = ("apex.y", "bend_45.y", "left_leg.y", "apex.x")
EDGES = ("start", "middle", "end")  # sections of a support


def run_rows(config, axis, values=None, loads=LOADS_N, seeds=SEEDS):
    """Return one row per case along an axis, at the largest gap of the configuration.

    axis: "step" or "step_exact" (values in steps per second), "modes" or "modes_alone" (highest
    frequency of the free modes, Hz).

    Row keys: axis, value, load_rms_N, seed, modes, then the statistics of `case_statistics`. Raises
    KeyError for another axis.
    """
    variant, default = AXES[axis]
    rows = []
    for value in values or default:
        run, model = variant(config, value)
        cases = [
            Case(load, max(config.grid.gap_m), seed) for load in loads for seed in range(seeds)
        ]
        for case, record in simulate_cases(run, model, cases):
            rows.append(
                {
                    "axis": axis,
                    "value": value,
                    "load_rms_N": case.load_rms_N,
                    "seed": case.seed,
                    "modes": model.modes,
                    **case_statistics(run, record),
                }
            )
    return rows


def step_variant(config, steps_per_second, scheme="newmark"):
    """Return (Config, ModalModel) of a run with another step and scheme and the same modes.

    A step that the configuration would refuse (omega step above 1) is set after its check: its
    effect is what is measured.
    """
    run = changed_config(config, RUN)
    integration = run.integration.model_copy(
        update={"steps_per_second": steps_per_second, "scheme": scheme}
    )
    return run.model_copy(update={"integration": integration}), build_model(run)


def exact_step_variant(config, steps_per_second):
    """Return (Config, ModalModel) of a run with another step of the exact scheme."""
    return step_variant(config, steps_per_second, "exact")


def modes_variant(config, free_modes_to_Hz):
    """Return (Config, ModalModel) of a run with another number of free modes.

    Constrained modes and attachment shapes are the same.
    """
    run = changed_config(
        config,
        {
            **RUN,
            "integration.steps_per_second": MODES_RATE,
            "integration.scheme": "newmark",
            "basis.free_modes_to_Hz": free_modes_to_Hz,
        },
    )
    return run, build_model(run)


def free_modes_alone(config, free_modes_to_Hz):
    """Return (Config, ModalModel) of a run on free modes only, as a control.

    The basis then lacks the shapes of local flexibility.
    """
    alone = {"basis.constrained_modes_to_Hz": NO_MODE_BELOW_HZ, "basis.attachment_shapes": False}
    run = changed_config(
        config,
        {
            **RUN,
            **alone,
            "integration.steps_per_second": MODES_RATE,
            "integration.scheme": "newmark",
            "basis.free_modes_to_Hz": free_modes_to_Hz,
        },
    )
    return run, build_model(run)


def case_statistics(config, record):
    """Return {name: value} of one record.

    rms_displacement_<sensor>_m.
    rms_force_N, contact_fraction, impact_rate_per_s, impact_velocity_rms_m_per_s, wear_work_rate_W:
    means over the supports (of the square for RMS values).
    rms_stress_root_Pa: of the larger root. rms_stress_support_Pa: the largest at a support.
    peak_stress_Pa, potential_energy_residual.
    band_<low>_<high>_dB: mean PSD of bend_45.y in a band, dB re 1 m²/Hz.
    """
    sensors = [str(name) for name in record["sensor"].values]
    displacement = record["displacement"].values
    values = {
        f"rms_displacement_{name}_m": np.sqrt(
            np.mean(np.square(displacement[sensors.index(name)], dtype=float))
        )
        for name in SENSORS
    }
    values["rms_force_N"] = np.sqrt(np.mean(record["rms_force"].values ** 2))
    for name, unit in (
        ("contact_fraction", ""),
        ("impact_rate", "_per_s"),
        ("wear_work_rate", "_W"),
    ):
        values[name + unit] = record[name].values.mean()
    values["impact_velocity_rms_m_per_s"] = np.sqrt(
        np.nanmean(record["impact_velocity_rms"].values ** 2)
    )
    sections = [str(name) for name in record["section"].values]
    stress = dict(zip(sections, record["stress_rms"].values, strict=True))
    values["rms_stress_root_Pa"] = max(
        value for name, value in stress.items() if name.startswith("root")
    )
    supports = tuple(str(name) for name in record["support"].values)
    at_supports = {f"{support}_{edge}" for support in supports for edge in EDGES}
    values["rms_stress_support_Pa"] = max(
        value for name, value in stress.items() if name in at_supports
    )
    spectra = segment_spectra(
        displacement[sensors.index("bend_45.y")][None],
        config.record.sampling_frequency_Hz,
        config.spectra,
    )
    psd = psd_statistics(spectra.values)[0][0]
    for low, high in BANDS_HZ:
        inside = (spectra.frequency >= low) & (spectra.frequency < high)
        values[f"band_{low:g}_{high:g}_dB"] = 10.0 * np.log10(psd[inside].mean())
    values["peak_stress_Pa"] = record["stress_peak"].values.max()
    values["potential_energy_residual"] = float(record["potential_energy_residual"])
    return {name: float(value) for name, value in values.items()}


# Axis -> (value -> (Config, ModalModel), its values)
AXES = {
    "step": (step_variant, STEP_RATES),
    "step_exact": (exact_step_variant, EXACT_RATES),
    "modes": (modes_variant, MODES_TO_HZ),
    "modes_alone": (free_modes_alone, MODES_TO_HZ[:1]),
}
