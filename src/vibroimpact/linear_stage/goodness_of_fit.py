"""Goodness of fit of the linear model to the lowest record, and which single change would mend it:
a factor common to all frequencies, one mode, a length or section, or one channel's gain, direction
or place.

A change in which the compared values are linear is a direction with a free amount in the
likelihood, which lowers chi-square (generalised least squares). A channel is tried at all places
that the structure has. Effects of the catalogue are not tried here: what they explain is adopted
before.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import starmap
from typing import Any

import numpy as np
from scipy import linalg, stats

from vibroimpact.campaign.file import CampaignError
from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.reading import ConfigError, check_config
from vibroimpact.observation.attached_model import attach
from vibroimpact.observation.strain import gauges_of
from vibroimpact.reduction.modal_model import ModalModel

from . import nuisance as linear
from . import priors
from .channel_places import channel_places
from .effect_fit import REACH, coarse, descended, moved
from .linearised import linearised, matched, same_modes
from .mode_identification import fit_modes, left, modelled_lines
from .other_lengths import Moved, parts, scaled
from .workbench import Workbench

LENGTH_REACH = 0.2  # of a length: largest change that is tried
SUSPECTS = 2  # channels, those that disagree most, are tried at other places
# of the largest singular value of the motion of all modes there: below it the tube moves in one
# direction, and a channel in another direction looks like one of another gain
ONE_WAY = 0.05


@dataclass(frozen=True)
class Mend:
    """A change of a linear model or of what is stated of a campaign.

    kind: frequencies, section, length, mode, gain, direction, place or channel (fits nowhere).
    which: name of the channel or the part, index of the mode among those fitted, None for all.
    amount: in the order of kinds, ln of the factor of frequency; factors of mass and stiffness per
    metre; factor of the length; ln of the factors of frequency and damping; gain over the model's;
    direction (3,); its place, see channel_places; differences of participations.
    chi_square: with it. freed: number of values that it fits.
    left: the largest residual over noise of a driven channel, None where it is unchanged.
    """

    kind: str
    which: Any
    amount: Any
    chi_square: float
    freed: int
    left: float | None = None

    @property
    def score(self) -> float:
        """Return chi-square with a cost for each fitted value."""
        return self.chi_square + 2.0 * priors.PARAMETER_COST * self.freed

    @property
    def shift(self) -> float:
        """Return ln of the factor by which another structure shifts frequencies, about so for one
        of several lengths.
        """
        if self.kind == "section":
            mass, stiffness = self.amount
            return float(0.5 * np.log(stiffness / mass))
        return float(-2.0 * np.log(self.amount) if self.kind == "length" else self.amount)


class LinearMisfit:
    """The chi-square of a Workbench's lowest record given its bare linear model, with nuisances
    marginalised.

    freed: number of fitted parameters of what was adopted; given: ModalModel without it, see bare
    in nuisance.difference.
    """

    def __init__(self, bench: Workbench, freed: int = 0, given: ModalModel | None = None) -> None:
        self.bench, self.freed, self.given_model = bench, freed, given
        self.left = left(bench.measured_fit, bench.bare)
        self.measured, self.simulated = bench.measured_reading, bench.bare_reading
        self.given = (
            None
            if given is None
            else linear.reading_of_model(
                given, same_modes(given, bench.measured_fit.modes, bench.bare)
            )
        )
        self.seen = linear.seen_by(self.measured, self.simulated)
        values, covariance = self._difference(self.simulated)
        self.count = len(values)
        self.factor = linalg.cholesky(covariance, lower=True)
        self.white = self._whitened(values)
        self.chi_square = float(self.white @ self.white)

    def p(self, chi_square: float | None = None, freed: int = 0) -> float:
        """Return the probability of as large a chi-square by chance, None for that of the model;
        freed: number of values fitted for it.
        """
        chi_square = self.chi_square if chi_square is None else chi_square
        return float(stats.chi2.sf(chi_square, max(1, self.count - self.freed - freed)))

    @cached_property
    def mends(self) -> list[Mend]:
        """Return the Mends, the likeliest first."""
        channels = self._channels
        found = [
            *self.of_structure,
            *map(self._mode, range(self.modes)),
            *map(self._channel, channels),
            *map(self._gain, channels),
            *filter(None, map(self._direction, channels[~self._gauges[channels]])),
        ]
        # for a place the modes are fitted again, which takes as long as all others together: only
        # where nothing else mends it
        if not any(self._mended(mend) for mend in found if mend.kind != "channel"):
            found += self.places
        return sorted(found, key=lambda mend: mend.score)

    def _mended(self, mend):
        return self.p(mend.chi_square, mend.freed) > priors.SIGNIFICANT

    @cached_property
    def of_structure(self) -> list[Mend]:
        """Return the Mends by another structure: a factor of all frequencies, another section,
        other lengths.
        """
        structure = self.bench.config.structure
        if structure.kind not in TUBES:
            return [self._frequencies()]
        lengths = starmap(self._length, parts(structure).items())
        return [self._frequencies(), self._section(), *filter(None, lengths)]

    @cached_property
    def places(self) -> list[Mend]:
        """Return the Mends by another place of the channels that disagree most."""
        channels = self._channels[~self._gauges[self._channels]]
        suspects = sorted(channels, key=lambda channel: self._channel(channel).chi_square)
        return [*filter(None, map(self._place, suspects[:SUSPECTS]))]

    @property
    def _gauges(self):
        """Return (channel,) bool: strain gauges, whose place and direction are not tried."""
        return gauges_of(self.bench.bare)

    @property
    def _channels(self):
        """Return (channel,) the indices of those that see a mode."""
        return np.flatnonzero(self.seen.any(axis=1))

    @property
    def modes(self) -> int:
        """Return the number of modes that are compared."""
        return len(self.measured.log_frequency)

    def _difference(self, simulated):
        """Return (values (value,), covariance) of modes and shapes, without the residuals of
        channels: these do not depend on the modes of the model, and are checked separately.
        """
        values, covariance, sensitivity = linear.difference(
            self.measured, simulated, self.seen, self.given
        )
        sensitivity = sensitivity * linear.spread(values, covariance, sensitivity)[0]
        own = slice(len(values) - len(self.seen))
        return values[own], (covariance + sensitivity @ sensitivity.T)[own, own]

    def _whitened(self, values):
        return linalg.solve_triangular(self.factor, values, lower=True)

    def _along(self, kind, which, directions):
        """Return the Mend with free amounts (direction,) of directions (value, direction)."""
        amounts, _, rank, _ = linalg.lstsq(self._whitened(directions), self.white)
        left = self.white - self._whitened(directions) @ amounts
        return Mend(kind, which, amounts, float(left @ left), int(rank))

    def _frequencies(self):
        """Return the Mend of one factor for all frequencies."""
        found = self._along("frequencies", None, self._frequency(slice(None))[:, None])
        return replace(found, amount=float(found.amount[0]))

    def _frequency(self, chosen):
        """Return (value,): the derivative of values by ln of the frequency of the chosen modes."""
        out = np.zeros(self.count)
        out[: self.modes][chosen] = 1.0
        return out

    def _mode(self, mode):
        """Return the Mend of the frequency and the damping of a mode."""
        damping = np.zeros(self.count)
        damping[self.modes + mode] = 1.0
        return self._along("mode", mode, np.stack([self._frequency(mode), damping], axis=1))

    def _rows(self, channel):
        """Return (value,) bool: the participations of a channel."""
        out = np.zeros(self.count, bool)
        first = 2 * self.modes
        out[first : first + self.seen.sum()] = np.nonzero(self.seen)[0] == channel
        return out

    def _shapes(self, channel, participations):
        """Return (value, row): participations (row, mode) of a channel as differences of
        values.
        """
        scale = self.measured.scale[channel]
        out = np.zeros((self.count, len(participations)))
        out[self._rows(channel)] = (participations / scale)[:, self.seen[channel]].T
        return out

    def _channel(self, channel):
        """Return the Mend of a channel with arbitrary participations."""
        return self._along(
            "channel", self._name(channel), np.eye(self.count)[:, self._rows(channel)]
        )

    def _gain(self, channel):
        """Return the Mend of a channel with another gain."""
        own = self._shapes(channel, self.simulated.participation[[channel]])
        found = self._along("gain", self._name(channel), own)
        return replace(found, amount=1.0 + float(found.amount[0]))

    def _direction(self, channel):
        """Return the Mend of a channel with another direction at its place, None where the tube
        moves in one direction there.
        """
        modes = self.bench.measured_fit.modes
        moving = self._sites.shapes(self.stated(channel))[:, modes]
        three = self._shapes(channel, moving * linear.driven(self.bench.bare.drive_shapes[modes]))
        size = linalg.svdvals(self._whitened(three))
        if size[1] <= ONE_WAY * size[0]:
            return None
        own = self._shapes(channel, self.simulated.participation[[channel]])[:, 0]
        # the measured participations of the channel, without those of the model
        rest = self.white + self._whitened(own)
        amounts, *_ = linalg.lstsq(self._whitened(three), rest, cond=ONE_WAY)
        left = rest - self._whitened(three) @ amounts
        return Mend(
            "direction", self._name(channel), amounts / linalg.norm(amounts), float(left @ left), 2
        )

    def _place(self, channel):
        """Return the Mend of a channel at another place along the tube, with the modes fitted again
        for that place; None where none can be fitted.
        """
        tried = self._sites.tried
        far = _farness(self.bench, channel, self._sites.shapes(tried))
        there = self._read_at(channel, tried[np.argmin(far)])
        if there is None:
            return None
        near = self._sites.about(there.stated(channel))
        chi_square = [there.moved_to(channel, place) for place in near]
        best = int(np.argmin(chi_square))
        return Mend(
            "place", self._name(channel), float(near[best]), chi_square[best], 1, there.left
        )

    def moved_to(self, channel: int, place: float) -> float:
        """Return the chi-square with a channel at a place, with the same modal fit."""
        modes, chain = self.bench.measured_fit.modes, self.bench.measuring
        gain = 1.0 if chain is None else chain.gain[channel] / chain.force_gain
        direction = self.bench.bare.sensor_directions[channel]
        drive = linear.driven(self.bench.bare.drive_shapes[modes])
        shape = direction @ self._sites.shapes(place)[:, modes] * drive
        rows = self.simulated.participation.copy()
        rows[channel] = gain * shape
        return self._chi_square(replace(self.simulated, participation=rows))

    def _chi_square(self, simulated):
        """Return the chi-square of the measured given another Reading."""
        values, covariance = self._difference(simulated)
        factor = linalg.cholesky(covariance, lower=True)
        white = linalg.solve_triangular(factor, values, lower=True)
        return float(white @ white)

    def _section(self):
        """Return the Mend of a tube with another mass per metre and bending stiffness throughout:
        one factor for all frequencies, one for all responses.
        """
        shapes = np.sum(
            [
                self._shapes(channel, self.simulated.participation[[channel]])[:, 0]
                for channel in range(len(self.seen))
            ],
            axis=0,
        )
        directions = np.stack([self._frequency(slice(None)), shapes], axis=1)
        found = self._along("section", None, directions)
        frequency, response = found.amount
        mass = 1.0 / max(1.0 + response, 1.0e-3)
        return replace(found, amount=(mass, mass * np.exp(2.0 * frequency)))

    def _length(self, name, keys):
        """Return the Mend of a tube with the lengths of a part times a factor, None where such a
        tube can not be built.
        """
        config = check_config(self.bench.values, "model")
        rough = coarse(config, REACH * self.bench.signals.band_Hz[1])

        def factor(unit):
            return 1.0 + LENGTH_REACH * (2.0 * float(unit[0]) - 1.0)

        try:
            start = self._reading_of_lengths(rough, keys, 1.0)
            unit, *_ = descended(
                lambda unit: moved(
                    self.simulated, self._reading_of_lengths(rough, keys, factor(unit)), start
                ),
                np.array([0.5]),
                self.measured,
                self.simulated,
            )
            found = self._reading_of_lengths(config, keys, factor(unit))
        except (ConfigError, CampaignError, ValueError, linalg.LinAlgError):
            return None
        return Mend("length", name, factor(unit), self._chi_square(found), 1)

    def _reading_of_lengths(self, config, keys, factor):
        """Return the Reading that a checked configuration predicts with lengths, by their keys,
        times a factor.
        """
        values = scaled(config.model_dump(mode="json"), keys, factor)
        structure = type(config.structure).model_validate(values["structure"])
        points = Moved(config.structure, structure)
        campaign = points.campaign(self.bench.campaign)
        model = linearised(attach(check_config(points.values(values), "model"), campaign))
        modes = matched(model, self.measured.log_frequency, self.measured.participation)
        return linear.gained(linear.reading_of_model(model, modes), self.bench.measuring)

    def _read_at(self, channel, place):
        """Return the LinearMisfit with a channel at a place and the modes fitted again, None where
        none can be fitted.
        """
        points = self.bench.campaign["channel_point"].astype(float).copy()
        points[channel] = self._sites.position(place)
        bench = self.bench.again(self.bench.campaign.assign(channel_point=points))
        bench.followed = True  # the other channels are unchanged: the modes are near the model's
        if bench.measured_fit is None:
            return None
        return LinearMisfit(bench, self.freed, self.given_model)

    def place(self, mend: Mend) -> np.ndarray:
        """Return (3,) m: the place to which a Mend moves its channel."""
        return self._sites.position(mend.amount)

    def off_m(self, mend: Mend) -> float:
        """Return how far in m that is from where the channel is stated to be, along a tube."""
        channel = self.bench.signals.names.index(mend.which)
        return self._sites.apart_m(mend.amount, self.stated(channel))

    def _name(self, channel):
        return self.bench.signals.names[channel]

    def stated(self, channel: int) -> float:
        """Return the place at which a channel is stated to be, see channel_places."""
        return self._sites.at(self.bench.bare.sensor_positions[channel], self._name(channel))

    @cached_property
    def _sites(self):
        return channel_places(self.bench)


def _farness(bench, channel, shapes):
    """Return (place,): the squared distance of the lines of a channel from those of the model at
    places of displacements (place, direction, mode), with the modes fitted to the other channels.
    """
    others = np.arange(len(bench.signals.names)) != channel
    model, record, signals = bench.bare, bench.linear_record, bench.signals
    responses = bench.valid(signals.response[signals.lowest])
    found = fit_modes(
        record.of(others),
        responses[others],
        _seen_through(model, model.sensor_shapes[:, others]),
        signals.kinds[others],
        signals.noise_in_band[others],
        bench.measured_fit.modes,
    )
    direction = model.sensor_directions[channel]
    there = _seen_through(model, np.einsum("sam,a->ms", shapes, direction))
    gain = 1.0 if bench.measuring is None else bench.measuring.gain[channel]
    expected = gain * modelled_lines(record, there, found, signals.kinds[channel])
    return np.sum(np.abs(record.spectra(responses[channel]) - expected) ** 2, axis=-1)


def _seen_through(model, shapes):
    """Return a ModalModel with sensors of shapes (mode, sensor) alone; their positions are not
    used.
    """
    count, gauges = shapes.shape[1], gauges_of(model)
    kept = {"gauges": np.zeros(count, bool)} if gauges.any() else {}
    return replace(
        model,
        **kept,
        sensor_shapes=shapes,
        sensor_names=tuple(f"sensor_{number}" for number in range(count)),
        sensor_positions=np.zeros((count, 3)),
        sensor_directions=np.tile([0.0, 0.0, 1.0], (count, 1)),
    )
