"""Poles and spectra against the LSCF of sdypy-EMA, pyOMA2, and scipy's averaged spectra.

All are given the same data as ours. The records are those of the linear tube with a bilateral
support, whose poles are known exactly.
"""

import numpy as np
from scipy import signal

from evidence.validation.check import Check
from evidence.validation.prediction.responses import synthesise_records
from vibroimpact.config.schema import Spectra
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.identify.linear.modes import contact_matrix, driven_block
from vibroimpact.identify.linear.poles import first_pole, frequency_of
from vibroimpact.identify.linear.responses import frf
from vibroimpact.identify.lscf import NormalEquations
from vibroimpact.identify.operational_pole import (
    PoleSearch,
    half_spectra,
    lag_window,
    operational_pole,
)
from vibroimpact.identify.peak import find_peak
from vibroimpact.identify.spectra.welch import (
    effective_averages,
    psd_statistics,
    segment_spectra,
)

from .presence import pyoma2, sdypy_ema

SUPPORT = (1.0e5, 62.0525)  # N/m, N s/m per support; c doubles the damping ratio of the first mode
RATE_HZ, DURATION_S, PERIOD_S, BAND_HZ = 256.0, 49.0, 51.0, (5.0, 100.0)
SEGMENTS = Spectra(segment_s=10.0, overlap=0.65, window="hann")
SEEDS, REFERENCES = 16, (0, 1)
EMA_STEP_HZ, EMA_BAND_HZ, EMA_ORDER, EMA_MODES = 0.05, (6.0, 240.0), 20, 3
ORDERS = (4, 8, 12, 24)
LONGEST_LAG_S = 1.5
SSI_ROWS, SSI_ORDER = 40, 16  # block rows of the Hankel matrix; states
SEARCH = {"band_Hz": (8.0, 60.0), "window": "hann", "max_order": 24}
PEAK_SEARCH_HZ = (8.0, 45.0)
# Relative to the pole. FRFs without noise: round-off times the condition of the normal equations.
EXACT_FRF = 1.0e-6
# The same spectra and order: the equations are the same; one code takes the transposed companion
# matrix.
SAME_EQUATIONS = 1.0e-6
SAME_RECORDS = 3.0  # standard errors of the mean difference, measured over the records
SAME_PSD = 1.0e-10  # the same formula


def cross_spectra(outputs: np.ndarray, references: np.ndarray) -> np.ndarray:
    """Return the averaged one-sided cross-spectra (output, reference, frequency).

    They are the mean over segments of X_output conj(X_reference).

    outputs: (output, segment, frequency) as in SegmentSpectra.
    references: (reference, segment, frequency).
    """
    return np.einsum("osf,rsf->orf", outputs, references.conj(), optimize=True) / outputs.shape[-2]


def sensors_across(model):
    """Return (mode, output) the sensor shapes across the plane of the tube."""
    return model.sensor_shapes[:, [name.endswith(".y") for name in model.sensor_names]]


def sdypy_checks(model) -> list[Check]:
    """Return the Checks of the first three poles across the plane from exact FRFs.

    Ours and sdypy-EMA's LSCF get the same FRFs. Raises JudgeAbsent.
    """
    ema = sdypy_ema()
    frequency = np.arange(0.0, RATE_HZ + 1.0e-9, EMA_STEP_HZ)
    response = frf(model, *SUPPORT, frequency, sensors_across(model))
    judge = ema.Model(
        frf=response.copy(),
        freq=frequency.copy(),
        lower=EMA_BAND_HZ[0],
        upper=EMA_BAND_HZ[1],
        pol_order_high=EMA_ORDER,
        frf_form="receptance",
    )
    judge.get_poles(method="lscf", show_progress=False)
    theirs = upper_half(judge.all_poles[-1])
    ours = NormalEquations(frequency, response[:, None, :], 2 * EMA_ORDER).poles(2 * EMA_ORDER)[0]
    checks = []
    for mode, exact in enumerate(exact_poles(model)[:EMA_MODES], start=1):
        judged = nearest(theirs, exact)
        for name, source, reference, found in (
            (
                f"LSCF pole on exact FRFs, mode {mode} across the plane",
                "sdypy-EMA, LSCF",
                judged,
                nearest(ours, exact),
            ),
            (f"sdypy-EMA's own LSCF pole, mode {mode}", "exact pole of the tube", exact, judged),
        ):
            checks.append(_pole_check("judge sdypy-EMA", name, source, reference, found, EXACT_FRF))
    return checks


def exact_poles(model):
    """Return (pole,) rad/s across the plane, by frequency, from the state matrix of the tube."""
    modes, (k, c) = driven_block(model), SUPPORT
    contact = contact_matrix(model)[modes]
    held, size = contact @ contact.T, len(modes)
    state = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [
                -np.diag(model.omega[modes] ** 2) - k * held,
                -np.diag(model.damping[modes]) - c * held,
            ],
        ]
    )
    poles = upper_half(np.linalg.eigvals(state))
    return poles[np.argsort(poles.imag)]


def _pole_check(case, name, source, reference, found, tolerance):
    """Return the Check of two poles in rad/s.

    reference is a magnitude; ours is it plus the distance of the poles in the complex plane.
    """
    return Check(
        case,
        name,
        "rad/s",
        abs(reference),
        source,
        abs(reference) + abs(found - reference),
        tolerance,
    )


def pyoma_checks(model, seeds=SEEDS) -> list[Check]:
    """Return the Checks of the first pole from records, against pyOMA2.

    Its pLSCF gets our half spectra, its SSI-cov the records. SSI works in the time domain and
    shares no code with ours: over `seeds` records the two means must agree within their scatter.
    Raises JudgeAbsent.
    """
    ssi, plscf = pyoma2()
    exact = first_pole(model, *SUPPORT)
    records = [record(model, seed) for seed in range(seeds)]
    checks = _same_spectra_checks(plscf, records[0], exact)
    ours, theirs = (
        np.array([frequency_of(pole) for pole in poles])
        for poles in (
            [_our_pole(motion) for motion in records],
            [_ssi_pole(ssi, motion, exact) for motion in records],
        )
    )
    error = (ours - theirs).std(axis=0, ddof=1) / np.sqrt(seeds)
    for part, (name, unit) in enumerate((("frequency", "Hz"), ("damping ratio", "1"))):
        checks.append(
            Check(
                "judge pyOMA2",
                f"{name} of the first pole, mean of {seeds} records, in standard errors of the"
                " difference",
                unit,
                theirs[:, part].mean(),
                "pyOMA2, SSI-cov",
                ours[:, part].mean(),
                SAME_RECORDS,
                scale=error[part],
            )
        )
    return checks


def _same_spectra_checks(plscf, motion, exact):
    """Return the Checks of pyOMA2's matrix fraction on our half spectra, by order."""
    spectra = segment_spectra(motion, RATE_HZ, SEGMENTS)
    weights, decay = lag_window(
        SEGMENTS.window, 2 * (spectra.frequency.size - 1), SEGMENTS.segment_s, LONGEST_LAG_S
    )
    halves = half_spectra(
        cross_spectra(spectra.values, spectra.values[list(REFERENCES)]), weights, slice(0, None)
    )
    checks = []
    for order in ORDERS:
        ours = nearest(
            NormalEquations(spectra.frequency, halves, order).poles(order)[0] + decay, exact
        )
        theirs = nearest(_discrete_poles(plscf, halves, order) + decay, exact)
        checks.append(
            _pole_check(
                "judge pyOMA2",
                f"pole of order {order} from the same half spectra",
                "pyOMA2, pLSCF",
                theirs,
                ours,
                SAME_EQUATIONS,
            )
        )
    return checks


def record(model, seed):
    """Return (output, time) m of the tube on its bilateral support, at 256 Hz.

    The force is band-limited noise at the shaker.
    """
    force = band_limited_noise(
        np.random.default_rng(seed), round(PERIOD_S * RATE_HZ), RATE_HZ, BAND_HZ
    )
    return synthesise_records(model, *SUPPORT, force, RATE_HZ, sensors_across(model))[
        :, : round(DURATION_S * RATE_HZ)
    ]


def _our_pole(motion):
    """Return our operational pole in rad/s of a record (output, time), without bias correction."""
    spectra = segment_spectra(motion, RATE_HZ, SEGMENTS)
    search = PoleSearch(spectra.frequency, **SEARCH)
    peak = find_peak(spectra.frequency, psd_statistics(spectra.values)[0][0], PEAK_SEARCH_HZ)
    found = operational_pole(
        spectra.values,
        REFERENCES,
        search,
        peak,
        effective_averages(DURATION_S, RATE_HZ, SEGMENTS),
        DURATION_S,
    )
    omega = 2.0 * np.pi * found.frequency
    return omega * (-found.damping_ratio + 1j * np.sqrt(1.0 - found.damping_ratio**2))


def _ssi_pole(ssi, motion, exact):
    """Return the pole in rad/s of pyOMA2's SSI-cov that is nearest to the exact one.

    motion: record (output, time).
    """
    hankel = ssi.build_hank(Y=motion, Yref=motion[list(REFERENCES)], br=SSI_ROWS, method="cov")[0]
    states = ssi.SSI_fast(hankel, SSI_ROWS, SSI_ORDER, step=2)[1][-1]
    return nearest(np.log(np.linalg.eigvals(states).astype(complex)) * RATE_HZ, exact)


def _discrete_poles(plscf, spectra, order):
    """Return (pole,) rad/s of pyOMA2's pLSCF of one order.

    spectra (output, reference, frequency): from 0 to half the rate.
    """
    denominators, numerators = plscf.pLSCF(spectra, 1.0 / RATE_HZ, order, sgn_basf=1)
    roots = np.linalg.eigvals(plscf.rmfd2ac(denominators[-1], numerators[-1])[0]).astype(complex)
    return np.log(roots[np.abs(roots) > 0.0]) * RATE_HZ


def upper_half(poles):
    """Return the finite poles with positive imaginary part."""
    poles = np.asarray(poles)
    return poles[np.isfinite(poles) & (poles.imag > 0.0)]


def nearest(poles, target):
    """Return the pole (complex, rad/s) of positive imaginary part nearest to a target."""
    poles = upper_half(poles)
    return poles[np.argmin(np.abs(poles - target))]


def spectrum_checks(model) -> list[Check]:
    """Return the Checks of a PSD and a cross-spectrum of a record against scipy.signal.

    The error is that of the worst bin, for each window.
    """
    motion, checks = record(model, 0), []
    for window in ("hann", "boxcar"):
        spectra = segment_spectra(
            motion, RATE_HZ, Spectra(segment_s=10.0, overlap=0.65, window=window)
        )
        length = round(10.0 * RATE_HZ)
        layout = {
            "fs": RATE_HZ,
            "window": window,
            "nperseg": length,
            "noverlap": round(0.65 * length),
            "detrend": False,
        }
        pairs = {
            "welch, PSD": (psd_statistics(spectra.values)[0], signal.welch(motion, **layout)[1]),
            "csd, cross-spectrum": (
                cross_spectra(spectra.values, spectra.values[:1])[1, 0],
                signal.csd(motion[0], motion[1], **layout)[1],
            ),
        }
        for name, (ours, theirs) in pairs.items():
            error = float(np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs)))
            checks.append(
                Check(
                    "judge scipy",
                    f"{name}, {window}: largest difference over its maximum",
                    "1",
                    0.0,
                    "scipy.signal",
                    error,
                    SAME_PSD,
                    scale=1.0,
                )
            )
    return checks
