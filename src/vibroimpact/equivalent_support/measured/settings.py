"""The settings of the identification, those of the model with the sensors of a campaign."""

from collections.abc import Sequence

import numpy as np

from vibroimpact.campaign.file import SAME_POINT_M, CampaignError
from vibroimpact.config.excitation import BandLimited
from vibroimpact.config.schema import Broadband, Identification, Lscf
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.identify.linear.modes import driven_block, first_mode
from vibroimpact.identify.peak import find_peak
from vibroimpact.identify.spectra.welch import segment_spectra
from vibroimpact.io.units import TIME_DERIVATIVES
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.study.cases import Case

from .tube import MeasuredTube

HELD = 1.0e9  # N/m: a tube that its supports hold
# References of LSCF if the model names none that was measured. More make it less stable at the low
# orders that it is read at.
REFERENCES = 2
# Bands if the model states none: from a part of the first frequency of the free tube to a multiple
# of the highest main peak of all records.
LOW, SEARCH, LSCF, BROADBAND = 0.6, 1.4, 1.9, 3.0
BEYOND = 1.3  # of the first frequency of the held tube: no main peak is sought above


def measured_settings(config: ConfigPart, tube: MeasuredTube) -> ConfigPart:
    """Return the configuration with the records and sensors of a campaign.

    Raises CampaignError if the records are too coarsely sampled for it.
    """
    rate, (low, high) = tube.signals.rate, tube.force.band_Hz
    identification = _with_sensors(config, tube)
    # The linear tube is taken to be driven in the band of the spectra that are kept: see
    # spectra.measured_spectra.
    excitation = BandLimited(
        kind="band_limited",
        point="force",
        direction=tube.direction,
        band_Hz=(max(low, lowest_read_Hz(identification)), high),
    )
    segment_s = round(config.spectra.segment_s * rate) / rate
    highest_Hz = identification.lscf.band_Hz[1]
    if 2.0 * highest_Hz > 0.5 * rate:
        raise CampaignError(
            f"sampling_frequency = {rate:g} Hz is too low for identification.lscf.band_Hz"
            f" up to {highest_Hz:g} Hz, which needs {4.0 * highest_Hz:g} Hz: give the model a lower"
            " upper end"
        )
    return config.model_copy(
        update={
            "spectra": config.spectra.model_copy(update={"segment_s": segment_s}),
            "record": config.record.model_copy(update={"sampling_frequency_Hz": rate}),
            "excitation": excitation,
            "identification": identification,
        }
    )


def lowest_read_Hz(identification: ConfigPart) -> float:
    """Return the lower end in Hz of the spectra that the identification reads."""
    own = identification
    return min(own.peak_search_Hz[0], own.lscf.band_Hz[0], own.broadband.band_Hz[0])


def _with_sensors(config: ConfigPart, tube: MeasuredTube) -> Identification:
    """Return the section identification with the names of channels as its points."""
    own = config.identification or _around_the_peaks(config, tube)
    response = _nearest(config, tube, own.response_point)
    broadband = _nearest(config, tube, own.broadband.point)
    by_size = [tube.points[each] for each in _by_motion(tube.model, own)]
    near = [_nearest(config, tube, point) for point in own.lscf.references]
    references = list(dict.fromkeys(filter(None, near)))
    found = list(dict.fromkeys([*references, *by_size[:REFERENCES]]))
    most = max(REFERENCES, len(references))
    return own.model_copy(
        update={
            "response_point": response or by_size[0],
            "lscf": own.lscf.model_copy(update={"references": tuple(found[:most])}),
            "broadband": own.broadband.model_copy(update={"point": broadband or by_size[0]}),
        }
    )


def _nearest(config: ConfigPart, tube: MeasuredTube, point: str) -> str | None:
    """Return the channel at a named point of the model, None if there is none."""
    if config.identification is None:
        return None
    places = tube.signals.points[tube.channels]
    away = np.linalg.norm(places - np.array(config.points[point]), axis=1)
    return tube.points[int(np.argmin(away))] if away.min() < SAME_POINT_M else None


def _by_motion(model: ModalModel, identification: Identification) -> list[int]:
    """Return the indices of the sensors, first those that the first mode moves most at any k."""
    block = driven_block(model)
    low, high = identification.stiffness_range_N_per_m
    vectors = [first_mode(model, block, k)[1] for k in (low, np.sqrt(low * high), high)]
    shapes = [np.abs(vector @ model.sensor_shapes[block]) for vector in vectors]
    size = np.prod([shape / shape.max() for shape in shapes], axis=0)
    return np.argsort(-size, kind="stable").tolist()


def _around_the_peaks(config: ConfigPart, tube: MeasuredTube) -> Identification:
    """Return bands that hold the main peaks of all records."""
    signals, model = tube.signals, tube.model
    block = driven_block(model)
    free, held = (first_mode(model, block, k)[0] / (2.0 * np.pi) for k in (1.0, HELD))
    low, top = LOW * free, 0.0
    orders = np.array([TIME_DERIVATIVES[signals.kinds[each]] for each in tube.channels])
    for response in signals.response:
        spectra = segment_spectra(
            response[tube.channels], signals.rate, config.spectra, BEYOND * held
        )
        power = np.mean(np.abs(spectra.values) ** 2, axis=1)
        # As velocities: neither the drift of integrated noise nor that of high modes is largest.
        power = power * np.maximum(spectra.frequency, low) ** (2.0 * (1.0 - orders[:, None]))
        psd = np.sum(power / power.max(axis=1, keepdims=True), axis=0)
        top = max(top, find_peak(spectra.frequency, psd, (low, BEYOND * held))[0])

    def band(factor: float) -> tuple[float, float]:
        return round(low, 2), round(factor * top, 2)

    return Identification(
        response_point="sensor",
        peak_search_Hz=band(SEARCH),
        lscf=Lscf(band_Hz=band(LSCF), references=("sensor",)),
        broadband=Broadband(point="sensor", band_Hz=band(BROADBAND)),
    )


def with_grid(config: ConfigPart, cases: Sequence[Case]) -> ConfigPart:
    """Return the configuration with the grid of some cases."""
    return config.model_copy(
        update={
            "grid": config.grid.model_copy(
                update={
                    "load_rms_N": tuple(sorted({case.load_rms_N for case in cases})),
                    "gap_m": tuple(sorted({case.gap_m for case in cases}, reverse=True)),
                    "seeds": 1 + max(case.seed for case in cases),
                }
            )
        }
    )
