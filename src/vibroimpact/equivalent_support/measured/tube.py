"""A measured tube: the linear model with the sensors of a campaign, which are also its shape line,
and with the forces on it, as far as they are known.

Measured forces act at their places, with the covariance that they have over the excited band.
Without one, turbulence of the model acts with its spectrum. Without either, every mode that the
model's excitation reaches is pushed alike and independently (white noise per unit of mass), and
nothing is said of the spectrum: pole and shape depend little on it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import CampaignError
from vibroimpact.campaign.signals import CampaignSignals, excited_band
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.diagnosis.measurement.attached_model import attach
from vibroimpact.diagnosis.measurement.sensed_motion import moving
from vibroimpact.excitation.line_force_spectrum import relative_psd as turbulence_psd
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.sections import outer_width
from vibroimpact.identify.linear.support_groups import reached_supports
from vibroimpact.identify.spectra.welch import driven_axis, effective_averages, segment_spectra
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.reduction.reduced_model import build_model

LEAST_MOTION = 0.02  # of the sensor that the force moves most
SMALLEST_PART = 1.0e-4  # of the variance of all forces
PUSHED_BEYOND = 1.5  # modes up to this multiple of the highest frequency are pushed
HIGHEST = 0.4  # of the sampling frequency, if no force shows how far records are of use
# Variance of a PSD over its mean, in that of chance: above it a force is not taken as white.
NOT_WHITE = 1.3
SMOOTHED = np.array([0.25, 0.5, 0.25])  # over lines, no wider than the analysis window


@dataclass(frozen=True)
class KnownForce:
    """The forces, as far as they are known.

    known: whether their places and spectrum are.
    band_Hz: the band of their power.
    drive_shapes: (mode, force) of independent forces with one spectrum.
    stated_psd: function of (frequency,) in Hz that gives their relative PSD (frequency,), if it
        is stated and not measured.
    """

    known: bool
    band_Hz: tuple[float, float]
    drive_shapes: np.ndarray
    stated_psd: Callable[[np.ndarray], np.ndarray] | None = None


def known_force(
    config: ConfigPart, signals: CampaignSignals, model: ModalModel, own_drive: np.ndarray
) -> KnownForce:
    """Return the KnownForce of a campaign.

    config: the model's configuration.
    model: attached to the campaign; its drives are the measured forces.
    own_drive: (mode, force) drives of the model's own excitation.

    Raises ValueError if that reaches no support.
    """
    if signals.forces:
        padded, _ = signals.padded(int(signals.valid_samples.max()))
        band = excited_band(padded, signals.rate)
        return KnownForce(True, band, model.drive_shapes @ _independent(config, signals, band))
    if config.excitation.kind == "turbulence":
        diameter = outer_width(config.structure.section)
        psd = partial(turbulence_psd, config.excitation, diameter)
        return KnownForce(True, tuple(config.excitation.band_Hz), own_drive, psd)
    band = (1.0 / config.spectra.segment_s, HIGHEST * signals.rate)
    _, modes = reached_supports(replace(model, drive_shapes=own_drive), groups_of(config))
    modes = modes[model.frequencies[modes] <= PUSHED_BEYOND * band[1]]
    return KnownForce(False, band, np.eye(model.modes)[:, modes])  # a force for each of them


def _independent(
    config: ConfigPart, signals: CampaignSignals, band_Hz: tuple[float, float]
) -> np.ndarray:
    """Return (force channel, force) the measured forces as a mix of independent ones."""
    total = np.zeros((len(signals.forces),) * 2)
    for force in signals.force:
        spectra = segment_spectra(force, signals.rate, config.spectra)
        inside = (spectra.frequency >= band_Hz[0]) & (spectra.frequency <= band_Hz[1])
        values = spectra.values[:, :, inside]
        products = np.einsum("isf,jsf->ij", values, values.conj()).real
        total += products / np.trace(products)
    variance, parts = np.linalg.eigh(total)
    kept = variance > SMALLEST_PART * variance[-1]
    return parts[:, kept] * np.sqrt(variance[kept] / variance.sum())


def groups_of(config: ConfigPart) -> str | tuple[tuple[str, ...], ...]:
    """Return identification.groups of a configuration, `all` if it has no identification."""
    return "all" if config.identification is None else config.identification.groups


def relative_psd(
    config: ConfigPart,
    signals: CampaignSignals,
    record: int,
    force: KnownForce,
    frequency: np.ndarray,
) -> np.ndarray | None:
    """Return (frequency,) the PSD of the forces of a record over its mean in their band.

    It is 1 outside the band. None if the forces are not known, or white within chance.

    frequency: (frequency,) Hz, the first lines of the spectra.
    """
    rate, spectra = signals.rate, config.spectra
    relative = np.ones(frequency.size)
    inside = (frequency >= force.band_Hz[0]) & (frequency <= force.band_Hz[1])
    if signals.forces:
        values = segment_spectra(signals.force[record], rate, spectra).values
        psd = np.mean(values.real**2 + values.imag**2, axis=1).sum(axis=0)[: frequency.size]
        averages = effective_averages(signals.force[record].shape[-1] / rate, rate, spectra)
        chance = 2.0 / (averages * len(signals.forces))
        if np.var(psd[inside]) < NOT_WHITE * chance * np.mean(psd[inside]) ** 2:
            return None
        psd = np.convolve(psd, SMOOTHED, mode="same")
    else:
        return None if force.stated_psd is None else force.stated_psd(frequency)
    relative[inside] = psd[inside] / np.mean(psd[inside])
    return relative


@dataclass(frozen=True, eq=False)
class MeasuredTube:
    """A linear tube as the sensors of a campaign see it.

    signals: of the campaign.
    model: its sensors are those of the campaign, from one end of the tube to the other. They are
        also the points of the shape line.
    force: KnownForce.
    channels: (sensor,) indices of their channels.
    points: (sensor,) names of their points, those of the channels without the axis at the end.
    direction: (3,) of the first force, or of the model's excitation.
    """

    signals: CampaignSignals
    model: ModalModel
    force: KnownForce
    channels: np.ndarray
    points: tuple[str, ...]
    direction: tuple[float, ...]


def measured_tube(
    config: ConfigPart, campaign: xr.Dataset, signals: CampaignSignals
) -> MeasuredTube:
    """Return the MeasuredTube of a campaign.

    Its sensors are those channels that measure a motion which the force causes.

    Raises CampaignError if there is none.
    """
    model = attach(config, campaign)
    own_drive = model.drive_shapes
    if not signals.forces:
        # The same places give the same mesh, and with it the same modes.
        places = {f"place_{number}": tuple(place) for number, place in enumerate(signals.points)}
        own = config.model_copy(update={"points": {**config.points, **places}})
        own_drive = build_model(own, motion_only=True).drive_shapes  # by its own excitation
    force = known_force(config, signals, model, own_drive)
    model = replace(model, drive_shapes=force.drive_shapes)
    _, modes = reached_supports(model, groups_of(config))
    size = np.abs(model.sensor_shapes[modes]).max(axis=0) * moving(signals.kinds)
    used = np.flatnonzero(size > LEAST_MOTION * size.max(initial=0.0))
    if not used.size:
        raise CampaignError("no channel measures a motion of the tube that the force causes")
    centreline = build_centreline(config.structure)
    arc_lengths = np.array([centreline.locate(signals.points[each], "a channel") for each in used])
    order = np.argsort(arc_lengths, kind="stable")
    used, arc_lengths = used[order], arc_lengths[order]
    direction = tuple(getattr(config.excitation, "direction", (0.0, 1.0, 0.0)))
    if signals.forces:
        direction = tuple(map(float, signals.force_directions[0]))
    axis = driven_axis(direction)
    points = tuple(signals.channels[each].removesuffix(f".{axis}") for each in used)
    sensed = replace(
        model,
        sensor_names=tuple(f"{point}.{axis}" for point in points),
        sensor_shapes=model.sensor_shapes[:, used],
        sensor_positions=model.sensor_positions[used],
        sensor_directions=model.sensor_directions[used],
        line_shapes=model.sensor_shapes[:, used],
        line_positions=model.sensor_positions[used],
        line_arc_length=arc_lengths,
    )
    return MeasuredTube(signals, sensed, force, used, points, direction)
