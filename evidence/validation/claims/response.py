"""Claims on the broadband response: anti-resonances, wide peaks, and the response point."""

import numpy as np

from evidence.validation.study_curves import median
from vibroimpact.identify.linear.responses import frf

from .claim import Claim, graded

VALLEY_SENSOR = "bend_45.y"
DEEP_dB = 15.0  # least depth of an anti-resonance of the linear tube
GONE_dB = 6.0  # depth below which a valley has vanished
RAISED_dB = 3.0  # height above the linear one from which a valley is filled
SAME_FREQUENCY = 0.02
SPREAD = 2.0  # times the wider of the two ends
SMOOTHING_HZ = 0.5


def valleys(curves, model, sensor=VALLEY_SENSOR):
    """Return {load: (valley, 3) dB} of the anti-resonances of the equivalent linear tube.

    Columns: depth in the linear tube; depth in the measured PSD; height of the measured valley
    above the linear one under the same force.

    Anti-resonances are minima of the linear response at `sensor` between the main peak and 150 Hz,
    at least DEEP_dB below the lower of the two adjacent maxima, from which depth is measured. The
    measured value is the smallest mean PSD within 5 % of the frequency.
    """
    k, c = median(curves.stiffness["broadband"]), median(curves.support_damping["broadband"])
    shape = model.sensor_shapes[:, [model.sensor_names.index(sensor)]]
    peaks, found = median(curves.pole_frequency["lscf"]), {}
    for i in np.flatnonzero(np.isfinite(k) & np.isfinite(c)):
        inside = (curves.frequency > 1.1 * peaks[i]) & (curves.frequency < 150.0)
        frequency = curves.frequency[inside]
        linear = 10.0 * np.log10(np.abs(frf(model, k[i], c[i], frequency, shape)[0]) ** 2)
        measured = 10.0 * np.log10(
            curves.psd[sensor][i].mean(axis=0)[inside] * curves.band_width_Hz / curves.load[i] ** 2
        )
        found[float(curves.load[i])] = np.array(
            [_valley(linear, measured, frequency, at) for at in _minima(linear)]
        ).reshape(-1, 3)
    return found


def _valley(linear, measured, frequency, at):
    low = measured[np.abs(frequency / frequency[at] - 1.0) < 0.05].min()
    return (_brim(linear, at) - linear[at], _brim(measured, at) - low, low - linear[at])


def _brim(level, at):
    """Return the lower of the maxima on both sides."""
    return min(level[:at].max(), level[at:].max())


def _minima(level):
    """Return the indices of the minima at least DEEP_dB below their brim."""
    inner = np.flatnonzero((level[1:-1] < level[:-2]) & (level[1:-1] <= level[2:])) + 1
    return [at for at in inner if _brim(level, at) - level[at] > DEEP_dB]


def anti_resonances(curves, model):
    """Return the Claim that anti-resonances vanish in the transition and above it."""
    found = np.concatenate(list(valleys(curves, model).values()) or [np.zeros((0, 3))])
    deep, left, raised = found.T
    gone = bool(found.size and np.median(left) < GONE_dB)
    value = (
        f"{len(found)} anti-resonances: {np.median(deep):.0f} dB deep in the linear tube,"
        f" {np.median(left):.0f} dB left ({left.min():.0f} to {left.max():.0f}), valleys"
        f" {np.median(raised):.0f} dB higher ({raised.min():.0f} to {raised.max():.0f})"
        if found.size
        else "none found"
    )
    return Claim(
        "anti-resonances vanish",
        "3.2",
        f"PSD at {VALLEY_SENSOR} at the anti-resonances of the equivalent linear tube, main peak to"
        " 150 Hz, medians",
        value,
        f"less than {GONE_dB:g} dB left; with conditions: every valley raised by {RAISED_dB:g} dB",
        graded(gone, bool(found.size and np.all(raised > RAISED_dB))),
        "impacts spread power over the band and fill the valleys; below contact the tube is linear"
        " and they stay",
    )


def _smooth(psd, frequency):
    width = max(int(round(SMOOTHING_HZ / (frequency[1] - frequency[0]))) | 1, 1)
    return np.convolve(psd, np.ones(width) / width, mode="same")


def peaks_by_sensor(curves):
    """Return {sensor: (load,) Hz}: centre of the main peak of the mean PSD.

    It is within 25 % of the LSCF frequency.
    """
    around = median(curves.pole_frequency["lscf"])
    return {
        name: np.array(
            [
                _peak(psd[i].mean(axis=0), curves.frequency, around[i])
                for i in range(len(curves.load))
            ]
        )
        for name, psd in curves.psd.items()
    }


def response_point(curves, model):
    """Return the Claim that peak frequencies do not depend on the response point."""
    peaks = np.array(list(peaks_by_sensor(curves).values()))
    deviation = (peaks.max(axis=0) - peaks.min(axis=0)) / np.median(peaks, axis=0)
    worst = int(np.argmax(deviation))
    return Claim(
        "peak frequencies do not depend on the response point",
        "3.2",
        f"main peak of the mean PSD at {', '.join(curves.psd)}",
        f"largest spread {100 * deviation[worst]:.2f} % at {curves.load[worst]:.3g} N, median"
        f" {100 * np.median(deviation):.2f} %",
        f"{100 * SAME_FREQUENCY:g} %",
        graded(deviation[worst] <= SAME_FREQUENCY, np.median(deviation) <= SAME_FREQUENCY),
        (
            "on the broad peaks of the transition the skirts of the second mode pull the centre at"
            " the legs"
            if deviation[worst] > SAME_FREQUENCY
            else "at every load and point"
        ),
    )


def _peak(psd, frequency, around):
    """Return the centre of the peak in Hz: mean frequency above half of the smoothed maximum."""
    smooth = _smooth(psd, frequency)
    inside = np.abs(frequency / around - 1.0) < 0.25
    high = inside & (smooth >= 0.5 * smooth[inside].max())
    return float(np.sum(frequency[high] * smooth[high]) / np.sum(smooth[high]))


def spread_peaks(curves, model, sensor="bend_45.y"):
    """Return the Claim that peaks widen near the second and third constrained modes.

    The measure is the effective bandwidth against load.
    """
    held = float(np.bincount(model.support_of_point, model.contact_stiffness).mean())
    spreads, centres = [], []
    for order in (1, 2):
        free, constrained = (_driven_frequencies(model, k, sensor)[order] for k in (1.0, held))
        inside = (curves.frequency > 0.92 * free) & (curves.frequency < 1.05 * constrained)
        width = np.array(
            [
                _bandwidth(seeds.mean(axis=0)[inside], curves.frequency[inside])
                for seeds in curves.psd[sensor]
            ]
        )
        top = int(np.argmax(width))
        spreads.append((width[0], width[top], width[-1], curves.load[top]))
        centres.append(constrained)
    growth = [top / max(low, 1e-9) for low, top, _, _ in spreads]
    falls = all(top > 1.1 * high for _, top, high, _ in spreads)
    value = "; ".join(
        f"mode near {centre:.0f} Hz: {low:.1f}, {top:.1f} (at {load:.3g} N), {high:.1f} Hz"
        for centre, (low, top, high, load) in zip(centres, spreads, strict=True)
    )
    return Claim(
        "PSD peaks spread near the second and third constrained modes",
        "3.1",
        f"effective bandwidth of the PSD at {sensor} between a mode's free and constrained"
        " frequency: lowest, widest, highest load",
        value,
        f"{SPREAD:g} times the lowest load's",
        graded(min(growth) >= SPREAD, max(growth) >= SPREAD),
        f"{min(growth):.0f} to {max(growth):.0f} times wider than below contact"
        + (", narrower again at the highest load" if falls else ""),
    )


def _driven_frequencies(model, k, sensor):
    """Return Hz of the modes with bilateral k in the plane of the sensor, lowest first."""
    modes = next(
        modes
        for modes, _ in model.blocks
        if np.any(model.sensor_shapes[modes, model.sensor_names.index(sensor)])
    )
    count = 12
    contact = model.contact_shapes[modes].reshape(len(modes), -1) * np.sqrt(
        np.repeat(model.contact_weight, 2)
    )
    squares = np.linalg.eigvalsh(np.diag(model.omega[modes] ** 2) + k * contact @ contact.T)
    return np.sqrt(squares[:count]) / (2.0 * np.pi)


def _bandwidth(psd, frequency):
    """Return the effective bandwidth in Hz: (integral of S)² over integral of S²."""
    step = frequency[1] - frequency[0]
    return float(np.sum(psd) ** 2 * step / np.sum(psd**2))
