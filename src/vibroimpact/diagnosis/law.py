"""The law that records demand: the forces at the supports that explain the sensors of a linear
structure, against the motion there. No law of contact takes part.

At each line, with y the sensors, F the driving force, f the unknown forces and H the receptances of
the modes,

    y = S H (b F + C' f) + noise,      r = C H (b F + C' f),

f has a Gaussian prior whose variance in each band is the most probable one; r is the motion at the
points of f. If few sensors know of a force, its prior keeps it small: see `resolution`.

Source: evidence of a linear model, D.J.C. MacKay, Neural Computation 4 (1992) 415-447, eq. 4.9;
impact forces from remote sensors, M. De Araújo, J. Antunes, P. Piteau, J. Sound Vib. 215 (1998)
1015-1041.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal.windows import tukey

from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.structure.contact.laws import LocalLaws

from .bench import Bench, settled
from .comparison import Comparison
from .constants import GAIN_SD
from .explanations import Point
from .measurement.sensed_motion import across, of_modes, orders
from .measurement.stretches import FADE_S, Stretch, stretches_of, valid_samples

MARGIN_S, TAPER_S = 2.0, 1.0  # on either side of a stretch, and faded of it
BANDS = 12  # logarithmic, each with a variance of its own
PASSES = 12  # of the variances
LEAST_POWER = 1.0e-12  # of the largest: of the prior of a force
SMOOTHED = 9  # lines over which the power of a sensor is averaged
SEEN = 0.7  # resolution from which a force is known


@dataclass(frozen=True, eq=False)
class Places:
    """The unknown forces: two resultants per support, and one along each local element.

    names, owners (place,): "left, y" and "left". shapes (mode, place): of a unit force that acts
    equally on the contact points of its support.
    """

    names: tuple[str, ...]
    owners: tuple[str, ...]
    shapes: np.ndarray


class Demand(NamedTuple):
    """The forces and motions that the sensors demand, in the band.

    force, motion (place, sample or line): N on the structure, and m.
    resolution (place,): share of each force that the sensors determine, 0 if only its prior does.
    explained: share of the power, which the linear model leaves, that the forces explain.
    beyond: that power, over the power of the sensors.
    """

    force: np.ndarray
    motion: np.ndarray
    resolution: np.ndarray
    explained: float
    beyond: float


def places_of(model: ModalModel) -> Places:
    """Return the Places of the supports and local elements of a model."""
    names, owners = [], []
    shapes = [np.zeros((model.modes, 0))]
    for support, owner in enumerate(model.support_names):
        names += [f"{owner}, {_axis(*along)}" for along in enumerate(across(model, support))]
        owners += [owner] * 2
        shapes.append(model.contact_shapes[:, model.support_of_point == support].mean(axis=1))
    elements = tuple(model.element_names)
    shapes.append(model.element_shapes)
    return Places((*names, *elements), (*owners, *elements), np.hstack(shapes))


def _axis(number, vector):
    """Return x, y or z for a vector along it, else "direction 1" or "direction 2"."""
    along = int(np.argmax(np.abs(vector)))
    return "xyz"[along] if abs(vector[along]) > 0.99 else f"direction {number + 1}"


def receptances(model: ModalModel, frequency: np.ndarray) -> np.ndarray:
    """Return (line, mode) kg^-1 s²: modal displacement over modal force at frequency (line,) Hz."""
    omega = 2.0 * np.pi * frequency[:, None]
    return 1.0 / (model.omega**2 - omega**2 + 1j * omega * model.damping)


def demanded(
    model: ModalModel,
    places: Places,
    frequency: np.ndarray,
    lines: tuple[np.ndarray, np.ndarray],
    variance: np.ndarray,
) -> Demand:
    """Return the Demand at frequency (line,) in Hz.

    lines: (drive (force_channel, line) N, sensors (sensor, line) m).
    variance (sensor, line): of noise and model, m²; infinite for a sensor without information.
    """
    drive, sensors = lines
    own = receptances(model, frequency)
    driven = own * (model.drive_shapes @ drive).T  # (line, mode)
    left = sensors.T - driven @ model.sensor_shapes
    matrix = np.einsum(
        "lm,ms,mp->lsp", own, model.sensor_shapes, places.shapes, optimize=True
    ) / np.sqrt(variance.T[..., None])
    white = left / np.sqrt(variance.T)
    normal = np.swapaxes(matrix.conj(), 1, 2) @ matrix
    pull = np.squeeze(np.swapaxes(matrix.conj(), 1, 2) @ white[..., None], -1)
    force, known, prior = _most_probable(normal, pull, frequency)
    motion = (driven + own * (force @ places.shapes.T)) @ places.shapes
    power = prior.sum(axis=0)
    resolution = np.sum(prior * known, axis=0) / np.where(power > 0.0, power, 1.0)
    misfit = white - np.squeeze(matrix @ force[..., None], -1)
    explained = 1.0 - float(np.sum(np.abs(misfit) ** 2) / max(np.sum(np.abs(white) ** 2), 1e-300))
    beyond = float(np.sum(np.abs(left) ** 2) / max(np.sum(np.abs(sensors) ** 2), 1e-300))
    return Demand(force.T, motion.T, np.clip(resolution, 0.0, 1.0), explained, beyond)


def _most_probable(normal, pull, frequency):
    """Return (force, known, variance) (line, place): forces with the most probable variances by
    band, and the share of each that the sensors know if all have the largest variance.

    normal (line, place, place), pull (line, place): of the whitened least squares.
    """
    edges = np.geomspace(frequency[0], frequency[-1], BANDS + 1)
    band = np.clip(np.searchsorted(edges, frequency, side="right") - 1, 0, BANDS - 1)
    count = pull.shape[1]
    force, known, variance = np.zeros_like(pull), np.zeros(pull.shape), np.zeros(pull.shape)
    for number in range(BANDS):
        own = band == number
        if not own.any() or not count:
            continue
        scale = np.maximum(np.einsum("lpp->p", normal[own]).real / own.sum(), 1.0e-100)
        wanted = np.abs(pull[own]) ** 2 / scale**2
        prior = wanted.mean(axis=0)  # (place,) N²
        least = LEAST_POWER * prior.max()
        if least == 0.0:
            continue  # nothing is demanded here
        prior = np.maximum(prior, least)
        for _ in range(PASSES):
            inverse = np.linalg.inv(normal[own] + np.diag(1.0 / prior))
            force[own] = np.squeeze(inverse @ pull[own][..., None], -1)
            share = 1.0 - np.einsum("lpp->lp", inverse).real / prior
            power = np.mean(np.abs(force[own]) ** 2, axis=0)
            prior = np.maximum(power / np.maximum(share.mean(axis=0), 1.0e-6), least)
        alike = prior.max()  # each force might have been the largest
        inverse = np.linalg.inv(normal[own] + np.eye(count) / alike)
        known[own] = 1.0 - np.einsum("lpp->lp", inverse).real / alike
        variance[own] = alike
    return force, known, variance


def demand_of(comparison: Comparison, bench: Bench, stretch: Stretch, point: Point) -> Demand:
    """Return the Demand on the linear structure of a Point by the settled samples of a stretch of a
    Bench.
    """
    structure, rates, band = comparison.structure, comparison.rates, comparison.band
    model, chain = structure.model(point), structure.measuring(point)
    first, last = _window(comparison, bench, stretch)
    samples, ratio = last - first, rates.steps_per_sample
    begin, duration = first / rates.sampling, samples / rates.sampling
    (longer,) = stretches_of(
        comparison.signals, [(stretch.record, begin)], duration, band, rates, structure.scale
    )
    steps = samples * ratio
    frequency = np.fft.rfftfreq(steps, 1.0 / rates.steps_per_second)
    inside = np.flatnonzero((frequency >= band[0]) & (frequency <= band[1]))
    frequency = frequency[inside]
    window = tukey(steps, min(2.0 * TAPER_S / duration, 1.0))[:, None]
    drive, sensors = (
        np.fft.rfft(values[1 : steps + 1] * window, axis=0)[inside].T
        for values in (longer.force / chain.force_gain, longer.motion / chain.gain)
    )
    sensors = sensors * np.exp(2j * np.pi * frequency * chain.delay[:, None])
    variance = _variance(comparison, frequency, sensors, float(np.sum(window**2)))
    found = demanded(model, places_of(model), frequency, (drive, sensors), variance)
    lines = np.zeros((2, len(found.resolution), samples // 2 + 1), complex)
    lines[..., inside] = found.force, found.motion
    series = np.fft.irfft(lines, samples, axis=-1) / ratio
    own = round(stretch.start_s * rates.sampling) - first + settled(bench)
    force, motion = series[..., own]
    return found._replace(force=force, motion=motion)


def _window(comparison, bench, stretch):
    """Return (first, last): samples of a stretch with margins, as far as its record has them."""
    sampling = comparison.rates.sampling
    whole = valid_samples(comparison.signals, stretch.record) / comparison.signals.rate
    end = min(stretch.start_s + bench.schedule.duration + MARGIN_S, whole - FADE_S)
    return round(max(stretch.start_s - MARGIN_S, 0.0) * sampling), round(end * sampling)


def _variance(comparison, frequency, motion, weight):
    """Return (sensor, line) m²: of noise and of the model error; infinite for a channel that
    measures no motion. weight: the sum of the squares of the window.
    """
    signals, rates = comparison.signals, comparison.rates
    density = (signals.noise * comparison.structure.scale) ** 2 / signals.rate  # two-sided
    order = orders(signals.kinds)[:, None]
    noise = density[:, None] / (2.0 * np.pi * frequency) ** (2 * order)
    noise *= rates.steps_per_second * weight
    power = uniform_filter1d(np.abs(motion) ** 2, SMOOTHED, axis=-1)
    out = noise + GAIN_SD**2 * power
    held = of_modes(signals.kinds)[:, None]
    return np.where(held, np.maximum(out, np.finfo(float).tiny), np.inf)


def element_force(laws: LocalLaws, element: int, motion: np.ndarray, rate: float) -> np.ndarray:
    """Return (sample,) N: the force of a local element on the structure for a motion (sample,) in m
    along it, sampled at a rate in Hz. See LocalLaws.
    """
    speed = np.gradient(motion) * rate
    own = {name: values[element] for name, values in vars(laws).items()}
    damper = own["damping"] * speed
    if own["damping_limit"] > 0.0:
        damper = np.clip(damper, -own["damping_limit"], own["damping_limit"])
    saturation = np.clip(
        own["saturation_stiffness"] * motion, -own["saturation_limit"], own["saturation_limit"]
    )
    slider = np.zeros(len(motion))
    for step, moved in enumerate(np.diff(motion), start=1):
        stretched = slider[step - 1] + own["stick_stiffness"] * moved
        slider[step] = min(max(stretched, -own["slip_limit"]), own["slip_limit"])
    elastic = own["stiffness"] * motion + own["quadratic"] * motion**2 + own["cubic"] * motion**3
    return -(elastic + damper + own["drag"] * np.abs(speed) * speed + slider + saturation)
