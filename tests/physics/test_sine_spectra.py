"""The spectra of a linear oscillator under a sine, through the public interface: exact power."""

import numpy as np
import pytest

import vibroimpact as vi
from vibroimpact.config.reading import check_config

MASS, NATURAL_HZ, RATIO, DRIVEN_HZ, FORCE_N = 2.0, 40.0, 0.02, 20.0, 5.0
STIFFNESS = MASS * (2.0 * np.pi * NATURAL_HZ) ** 2
POINT = {"point": "mass", "direction": [1.0, 0.0, 0.0]}


def structure_of(kind, folder):
    if kind == "chain":
        return {
            "kind": "chain",
            "masses": [{"name": "mass", "mass_kg": MASS}],
            "springs": [{"between": ["ground", "mass"], "stiffness_N_per_m": STIFFNESS}],
        }
    for name, value in (("mass", MASS), ("stiffness", STIFFNESS)):
        np.savez(folder / f"{name}.npz", np.array([[value]]))
    files = {name: str(folder / f"{name}.npz") for name in ("mass", "stiffness")}
    return {"kind": "matrices", **files, "points": {"mass": {"x": 0}}}


def study(kind, folder, excitation, **sections):
    """The stop is out of reach."""
    return check_config(
        {
            "study": "sine",
            "structure": structure_of(kind, folder),
            "damping": {"kind": "modal", "other_ratio": RATIO},
            "supports": [
                {
                    "name": "stop",
                    "point": "mass",
                    "stiffness_N_per_m": 1.0e5,
                    "profile": {"kind": "planes", "normals_deg": [0.0]},
                }
            ],
            "excitation": excitation,
            "grid": {"load_rms_N": [FORCE_N], "gap_m": [1.0], "seeds": 1},
            "record": {"duration_s": 30.0, "sensors": {"points": ["mass"], "directions": ["x"]}},
            **sections,
        },
        "sine",
    )


@pytest.mark.parametrize("kind", ["chain", "matrices"])
def test_the_power_of_a_sine_is_that_of_the_closed_form(kind, tmp_path):
    config = study(kind, tmp_path, {"kind": "harmonic", "frequency_Hz": DRIVEN_HZ, **POINT})
    record = vi.simulate_case(config, load_rms_N=FORCE_N, gap_m=1.0)
    spectra = vi.case_spectra(config, record)
    omega = 2.0 * np.pi * DRIVEN_HZ
    receptance = 1.0 / abs(
        STIFFNESS - MASS * omega**2 + 2j * RATIO * omega * np.sqrt(STIFFNESS * MASS)
    )
    power = (FORCE_N * receptance) ** 2  # mean square
    psd, frequency = spectra["psd_displacement_mean"].values[0], spectra["frequency"].values
    step, peak = frequency[1], int(np.argmax(psd))
    assert frequency[peak] == pytest.approx(DRIVEN_HZ)
    assert psd[peak - 10 : peak + 11].sum() * step == pytest.approx(power, rel=1e-4)
    # of a Hann window: an equivalent noise bandwidth of 1.5 lines
    assert psd[peak] == pytest.approx(power / (1.5 * step), rel=1e-4)
    assert spectra.sizes["low_frequency"] == spectra.sizes["frequency"]


def test_free_motion_has_spectra_of_all_sensors(tmp_path):
    """Without a force there is no driven direction."""
    released = {"displacement_m": {"mass": {"x": 1.0e-3}}}
    at_once = {"start_up_s": 0.0, "imperfection": 0.0}
    sections = {"initial": released, "integration": at_once}
    config = study("chain", tmp_path, {"kind": "none"}, **sections)
    record = vi.simulate_case(config, load_rms_N=FORCE_N, gap_m=1.0, duration_s=20.0)
    assert vi.case_spectra(config, record).sizes["driven_sensor"] == 1
