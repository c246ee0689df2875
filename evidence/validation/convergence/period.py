"""Period error of the integration on the linear tube: free vibration at several steps.

Average acceleration is the trapezoidal rule. In one step an undamped mode turns by the angle
2 atan(omega dt / 2) instead of omega dt, so that its frequency is

    omega' / omega = 2 atan(omega dt / 2) / (omega dt) = 1 - (omega dt)² / 12 + O((omega dt)⁴).

The amplitude is exact. This is measured on whole runs through the compiled integration and the
output filter.
"""

from dataclasses import replace

import numpy as np

from evidence.validation.check import Check
from vibroimpact.integration.batch import Schedule, integrate_batch
from vibroimpact.reduction.reduced_model import build_model

from .rate import fitted_order

CASE = "convergence: step"
STEP_RATES = (51200, 102400, 204800)  # steps per second
SAMPLING_HZ = 5120.0  # passes to 2000 Hz
DURATION_S = 2.0
BAND_HZ = (40.0, 1500.0)  # of the modes that start; slower ones lag less than can be estimated
SHORT_S = 0.02  # the fastest mode lags by 2 rad in this time at the longest step
LARGE_GAP_M = 1.0  # nothing touches
ORDER, CONSTANT = 2.0, 1.0 / 12.0
ORDER_TOLERANCE, CONSTANT_TOLERANCE = 0.02, 0.01  # absolute; relative
DAMPING_TOLERANCE = 1.0e-8  # absolute; records are float32
# omega dt: below it the fourth-order term, (3/20) (omega dt)² of the second-order one, is under 1 %
SMALL_ANGLE = 0.1


def period_rows(config, rates=STEP_RATES):
    """Return one row per step and mode.

    Row keys: steps_per_second, mode_Hz, omega_step (omega dt), shift (1 - measured / true
    frequency), exact (the formula's), numerical_damping (ratio, from the loss of amplitude).
    """
    model = build_model(config)
    started = driven_modes(model)
    rows = []
    for rate in rates:
        shift, lost = frequency_shift(model, started, rate)
        angle = model.omega[started] / rate
        rows += [
            {
                "steps_per_second": rate,
                "mode_Hz": model.frequencies[mode],
                "omega_step": own,
                "shift": value,
                "exact": 1.0 - 2.0 * np.arctan(0.5 * own) / own,
                "numerical_damping": ratio,
            }
            for mode, own, value, ratio in zip(started, angle, shift, lost, strict=True)
        ]
    return rows


def driven_modes(model):
    """Return (started,) indices of the modes in BAND_HZ that move the shape line, out of plane."""
    seen = np.abs(model.line_shapes).max(axis=1) > 0.0
    return np.flatnonzero(
        seen & (model.frequencies > BAND_HZ[0]) & (model.frequencies < BAND_HZ[1])
    )


def frequency_shift(model, started, rate):
    """Return (1 - measured / true frequency, damping ratio), each (started,), of free vibration.

    rate: steps per second. There is no damping. All modes start together with equal amplitudes;
    their shapes on the shape line separate them again, by least squares.
    """
    amplitude = np.zeros(model.modes)
    amplitude[started] = 1.0e-3
    free = replace(model, damping=np.zeros(model.modes), initial_displacement=amplitude)
    schedule = Schedule(rate, SAMPLING_HZ, 0.1, DURATION_S)
    points = model.contact_weight.size
    lanes = integrate_batch(
        free,
        schedule,
        gap=np.array([LARGE_GAP_M]),
        imperfection=np.zeros((points, 2, 1)),
        drive=lambda first, count: np.zeros((count, model.drive_shapes.shape[1], 1)),
    )
    line = lanes.displacement[0, model.sensor_shapes.shape[1] :].astype(float)
    modal = np.linalg.lstsq(model.line_shapes[started].T, line, rcond=None)[0]
    found = np.array(
        [
            slip_and_decay(series, omega)
            for series, omega in zip(modal, model.omega[started], strict=True)
        ]
    )
    return -found[:, 0] / model.omega[started], found[:, 1] / model.omega[started]


def slip_and_decay(series, omega):
    """Return (angular frequency above `omega` in rad/s, decay rate in 1/s) of a sine (time,).

    The frequency follows from the phase between short stretches, which is less than a full turn,
    then from the phase between the halves of the record.
    """
    time = np.arange(series.size) / SAMPLING_HZ
    turned = series * np.exp(-1j * omega * time)
    short, half = round(SHORT_S * SAMPLING_HZ), series.size // 2
    coarse = np.median(np.angle(_ratios(turned, 5 * short, short))) / SHORT_S
    ratio = _ratios(turned * np.exp(-1j * coarse * time), half, half)[0]
    return (
        coarse + np.angle(ratio) * SAMPLING_HZ / half,
        -np.log(np.abs(ratio)) * SAMPLING_HZ / half,
    )


def _ratios(turned, length, hop):
    """Return complex ratios of Hann-weighted sums over stretches, each to an earlier one.

    length: samples of a stretch. hop: samples between the two.
    """
    window = np.hanning(length)
    sums = np.array(
        [
            window @ turned[first : first + length]
            for first in range(0, turned.size - length + 1, hop)
        ]
    )
    return sums[1:] / sums[:-1]


def period_checks(rows):
    """Return the Checks of the order in the step, of the constant 1/12, and of zero damping.

    The order is that of the worst mode; the constant is taken over small angles.
    """
    small = [row for row in rows if row["omega_step"] < SMALL_ANGLE]
    orders = []
    for mode in dict.fromkeys(row["mode_Hz"] for row in small):
        own = [row for row in small if row["mode_Hz"] == mode]
        if len(own) > 2:
            orders.append(
                fitted_order([row["omega_step"] for row in own], [row["shift"] for row in own])
            )
    constants = [row["shift"] / row["omega_step"] ** 2 for row in small]
    source = "trapezoidal rule: 2 atan(omega dt / 2) = omega dt (1 - (omega dt)² / 12)"
    farthest = [
        max(values, key=lambda value: abs(value - goal))
        for values, goal in ((orders, ORDER), (constants, CONSTANT))
    ]
    return [
        Check(
            CASE,
            "order of the frequency error of linear modes",
            "1",
            ORDER,
            source,
            float(farthest[0]),
            ORDER_TOLERANCE,
            1.0,
        ),
        Check(
            CASE,
            "numerical damping ratio of linear modes",
            "1",
            0.0,
            "average acceleration keeps amplitudes",
            float(max((row["numerical_damping"] for row in rows), key=abs)),
            DAMPING_TOLERANCE,
            1.0,
        ),
        Check(
            CASE,
            "frequency error of linear modes over (omega dt)²",
            "1",
            CONSTANT,
            source,
            float(farthest[1]),
            CONSTANT_TOLERANCE,
        ),
    ]
