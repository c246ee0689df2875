"""The place along a tube of a force that acts in the lowest record besides the measured one: part
of the check for other sources.

What is not a linear response to the measured force is the linear response to another force: of a
spring, a rub, a stop, or a source that was not measured. Its time history is unknown, so every line
has its own amplitude. The ratios between channels are those of the transfer functions from the
place where the force acts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibroimpact.effects.places import length_m, stations
from vibroimpact.geometry.directions import transverse_directions
from vibroimpact.observation.attached_model import displacement_shapes
from vibroimpact.observation.sensed_motion import differentiated
from vibroimpact.observation.strain import STRAIN

from . import priors
from .other_source import BLOCK, FREE, incoherent_rest
from .workbench import Workbench

PLACES = 64  # along the tube
ANGLES = np.deg2rad(np.arange(0.0, 180.0, 15.0))  # of the force across the tube
LEAST_CHANNELS = 3  # two have one ratio, which some place always gives
CLEAR = 4.0  # times the power by chance: less identifies no place
EXPLAINED = 0.7  # of the power: where one force explains less, several act
TOLD = 0.34  # of the tube: a longer interval of places is not reported


@dataclass(frozen=True)
class ActingPlace:
    """A force besides the measured one.

    low_m, high_m: arc lengths between which it acts. arc_length_m: the most likely one.
    direction (3,): there.
    share: of the power that is not a linear response to the measured force which it explains.
    support: the name of one at that place, None for none.
    """

    low_m: float
    arc_length_m: float
    high_m: float
    direction: tuple[float, ...]
    share: float
    support: str | None


def acting_place(bench: Workbench) -> ActingPlace | None:
    """Return the ActingPlace of the lowest record of a Workbench; None where its structure is no
    tube, noise explains the record, or the channels do not determine the place.
    """
    length, read = length_m(bench.values), bench.signals.kinds != STRAIN
    if length is None or read.sum() < LEAST_CHANNELS:
        return None
    rest, noise = (rows[read] for rows in incoherent_rest(bench))
    rest = rest / noise[..., None]
    power = np.sum(np.abs(rest) ** 2)
    values = rest.size * (1.0 - FREE / BLOCK)
    if power < CLEAR * values:
        return None
    places = np.array(list(stations(bench.values, PLACES)[0].values()))
    tangents = np.gradient(places, axis=0)
    axes = np.array([transverse_directions(row / np.linalg.norm(row)) for row in tangents])
    explained = _explained(bench, rest, noise, places, axes)
    by_place = explained.max(axis=1)
    best = int(np.argmax(by_place))
    left = power - by_place[best]
    # the uncertainty by gains of channels and by the shapes of the model
    known = max(1.0, left / values) * priors.LINEAR_GAIN + priors.GAIN_SD**2 * power
    likely = np.flatnonzero(by_place > by_place[best] - known)
    step = length / PLACES
    low = max(likely[0] - 1, 0) * step  # one more on either side
    high = min(likely[-1] + 2, PLACES) * step
    if by_place[best] < EXPLAINED * power or high - low > TOLD * length:
        return None
    angle = ANGLES[np.argmax(explained[best])]
    direction = np.cos(angle) * axes[best, 0] + np.sin(angle) * axes[best, 1]
    return ActingPlace(
        float(low),
        float((best + 0.5) * step),
        float(high),
        tuple(map(float, direction)),
        float(by_place[best] / power),
        _support(bench.bare, places[likely[0] : likely[-1] + 1], step),
    )


def _support(model, places, within):
    """Return the name of the first support with a contact point within some m of places (place, 3),
    None where there is none.
    """
    away = np.linalg.norm(model.contact_position[:, None] - places, axis=-1)
    near = model.support_of_point[(away < within).any(axis=1)]
    return str(model.support_names[near[0]]) if len(near) else None


def _explained(bench, rest, noise, places, axes):
    """Return (place, angle): the power of rest (channel, block, BLOCK), over noise (channel,
    block), that one force at each of places (place, 3) at each angle between axes (place, 2, 3)
    explains; strains are left out, as their shapes are not among the displacements.
    """
    read = bench.signals.kinds != STRAIN
    model, shapes = displacement_shapes(
        bench.config, np.vstack([bench.campaign["channel_point"].values[read], places])
    )
    channels = len(rest)
    sensed = np.einsum("mca,ca->cm", shapes[:, :channels], bench.bare.sensor_directions[read])
    driven = np.einsum("mpa,pia->ipm", shapes[:, channels:], axes)
    lines = np.arange(rest[0].size)
    omega = 2.0 * np.pi * bench.linear_record.frequency[lines]
    receptance = 1.0 / (model.omega[:, None] ** 2 - omega**2 + 1j * model.damping[:, None] * omega)
    # products of transfer functions with the rest, and with each other
    along = np.zeros((2, len(places), len(lines)), complex)
    own = np.zeros((2, 2, len(places), len(lines)))
    for channel, kind in enumerate(bench.signals.kinds[read]):
        weight = differentiated(omega, kind) / np.repeat(noise[channel], BLOCK)
        transfer = (driven * sensed[channel]) @ receptance * weight
        along += transfer.conj() * rest[channel].ravel()
        own += np.real(transfer[:, None].conj() * transfer)
    out = []
    for turn in np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1):
        size = np.einsum("i,j,ijpl->pl", turn, turn, own)
        out.append(np.sum(np.abs(np.tensordot(turn, along, 1)) ** 2 / (size + 1.0e-300), axis=-1))
    return np.array(out).T
