"""The spectrum of a turbulent force per length: dimensionless spectra and tables."""

from collections.abc import Sequence

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart

# Of the two slopes: reduced frequency where they meet, (factor, exponent) below and above it.
CORNER = 0.2
BELOW, ABOVE = (5.0e-3, 0.5), (4.0e-5, 3.5)
# Of the low pass: value at 0, cut-off, exponent.
LOW_PASS = (1.5e-3, 0.1, 2.7)
# Of the two-phase spectrum: factors of the powers 1/2, 3/2, ... of the void fraction in the decimal
# logarithm of its level, the divisor of the level, exponents of reduced frequency and mass flux.
VOID_FACTORS = (24.042, -50.421, 63.483, -33.284)
VOID_DIVISOR, TWO_PHASE_SLOPE, FLUX_EXPONENT = 6.8e-2, 2.0, 4.0
INTERVALS = 20_000  # of the quadrature over the band, evenly spaced in the logarithm


def line_force_psd(force: ConfigPart, diameter: float, frequency: np.ndarray) -> np.ndarray:
    """Return the one-sided PSD (frequency,) of the force per length in (N/m)²/Hz.

    It is 0 outside the band. A flat spectrum is that of a force per length of 1 N/m RMS.

    force: section of the configuration, of kind turbulence.
    diameter: outer diameter of the tube in m.
    frequency: (frequency,) Hz, above 0 inside the band.
    """
    frequency = np.asarray(frequency, dtype=float)
    low, high = force.band_Hz
    inside = (frequency >= low) & (frequency <= high)
    out = np.zeros(frequency.shape)
    out[inside] = _inside_the_band(force, diameter, frequency[inside])
    return out


def relative_psd(force: ConfigPart, diameter: float, frequency: np.ndarray) -> np.ndarray:
    """Return (frequency,) line_force_psd over its mean in the band, and 1 outside the band.

    Arguments as there.
    """
    psd = line_force_psd(force, diameter, frequency)
    return np.where(psd > 0.0, psd / np.mean(psd[psd > 0.0]), 1.0)


def _inside_the_band(force: ConfigPart, diameter: float, frequency: np.ndarray) -> np.ndarray:
    spectrum = force.spectrum
    if spectrum.kind == "flat":
        return np.full(frequency.shape, 1.0 / (force.band_Hz[1] - force.band_Hz[0]))
    if spectrum.kind == "table":
        return log_interpolation(frequency, spectrum.frequency_Hz, spectrum.psd_N2_per_m2_Hz)
    time = diameter / spectrum.velocity_m_per_s  # s
    force_per_length = (
        0.5 * spectrum.fluid_density_kg_per_m3 * spectrum.velocity_m_per_s**2 * diameter
    )
    reduced = frequency * time
    if spectrum.kind == "reduced_table":
        values = log_interpolation(reduced, spectrum.reduced_frequency, spectrum.reduced_psd)
    elif spectrum.kind == "two_phase":
        flux = spectrum.fluid_density_kg_per_m3 * spectrum.velocity_m_per_s
        values = 2.0 * two_phase_spectrum(reduced, spectrum.void_fraction, flux)
    else:
        values = 2.0 * tube_bundle_spectrum(reduced, spectrum.shape)
    return force_per_length**2 * time * values


def tube_bundle_spectrum(reduced_frequency: np.ndarray, shape: str) -> np.ndarray:
    """Return the dimensionless two-sided PSD of the force per length across a tube in a bundle.

    The PSD over frequencies f of either sign is (density V² D / 2)² D / V times it.

    reduced_frequency: f D / V, above 0.
    shape: two_slopes or low_pass.

    Source: code_aster, DEFI_SPEC_TURB (manual U4.44.31), default values of SPEC_LONG_COR_3 and of
    SPEC_LONG_COR_2; scaled as in routine spect1. That the spectrum is two-sided follows from
    POST_DYNA_ALEA, which doubles its integral over the positive frequencies to get the variance.
    """
    reduced = np.asarray(reduced_frequency, dtype=float)
    if shape == "low_pass":
        level, cut_off, exponent = LOW_PASS
        return level / (1.0 + (reduced / cut_off) ** exponent)
    return np.where(
        reduced <= CORNER, BELOW[0] * reduced ** -BELOW[1], ABOVE[0] * reduced ** -ABOVE[1]
    )


def two_phase_spectrum(
    reduced_frequency: np.ndarray, void_fraction: float, mass_flux: float
) -> np.ndarray:
    """Return the dimensionless two-sided PSD of the force of a two-phase flow across a bundle.

    The scale is that of tube_bundle_spectrum, with the density of the mixture.

    reduced_frequency: f D / V, above 0.
    void_fraction: share of steam in the volume.
    mass_flux: density of the mixture times velocity, kg/(m² s).

    Source: code_aster, DEFI_SPEC_TURB (manual U4.44.31), default exponents of SPEC_LONG_COR_4; its
    level is a fit over the void fraction, in routine coesp4.
    """
    powers = void_fraction ** (0.5 + np.arange(len(VOID_FACTORS)))
    level = 10.0 ** (VOID_FACTORS @ powers) / VOID_DIVISOR
    reduced = np.asarray(reduced_frequency, dtype=float)
    return level / (reduced**TWO_PHASE_SLOPE * mass_flux**FLUX_EXPONENT)


def log_interpolation(
    at: np.ndarray, places: Sequence[float], values: Sequence[float]
) -> np.ndarray:
    """Return values on the straight lines between points on two logarithmic axes.

    Beyond the first and the last point it is the value there.
    """
    return np.exp(np.interp(np.log(at), np.log(places), np.log(values)))


def line_force_rms(force: ConfigPart, diameter: float) -> float:
    """Return the RMS of the force per length in N/m: the root of the integral of line_force_psd."""
    low, high = force.band_Hz
    frequency = np.geomspace(low, high, INTERVALS + 1)
    frequency[[0, -1]] = low, high
    return float(np.sqrt(np.trapezoid(line_force_psd(force, diameter, frequency), frequency)))
