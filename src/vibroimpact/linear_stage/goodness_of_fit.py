"""Whether a linear model fits the lowest record at all, and which single change would mend it: a
factor common to all frequencies, one mode, or one channel's gain, direction or place.

Changes that are linear in what is compared are directions left free in the likelihood, whose
chi-square falls by what lies along them (generalised least squares). A channel is tried all along
the tube. Effects of the catalogue are not tried here: what they explain is adopted before.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import starmap

import numpy as np
from scipy import interpolate, linalg, stats

from vibroimpact.campaign.file import CampaignError
from vibroimpact.config.reading import ConfigError, check_config
from vibroimpact.discrepancy import priors
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.observation.attached_model import attach
from vibroimpact.observation.strain import gauges_of

from . import nuisance as linear
from .effect_fit import REACH, coarse, descended, moved
from .linearised import linearised, matched, same_modes
from .mode_identification import fit_modes, left, modelled_lines
from .other_lengths import Moved, parts, scaled

ALONG = 97  # places along the tube at which shapes are computed; between them splines
TRIED = 241  # places along the tube that a channel is tried at
NEARBY_M, NEARBY = 0.02, 41  # about the best of them, and how many places there
LENGTH_REACH = 0.2  # of a length: how far from its stated value it is looked for
SUSPECTS = 2  # channels, those that disagree most, are tried elsewhere
# of a direction's largest part: below it the tube moves one way there, and a channel that is turned
# reads as one of another gain
ONE_WAY = 0.05


@dataclass(frozen=True)
class Mend:
    """A change of a linear model or of what is stated of a campaign.

    kind: frequencies, section, length, mode, gain, direction, place or channel (fits nowhere);
    which: name of the channel or the part, number of the mode among those fitted, None for all;
    amount: ln of the factor of frequency; factors of mass and stiffness per metre; factor of the
    length; ln of the factors of frequency and damping; gain over the model's; direction (3,); m
    along the tube; chi_square with it; freed:
    values that it chooses; left: the largest residual over noise of a driven channel, None where
    it is as it was.
    """

    kind: str
    which: object
    amount: object
    chi_square: float
    freed: int
    left: float | None = None

    @property
    def score(self):
        """Return chi-square with a cost for each value that is free."""
        return self.chi_square + 2.0 * priors.PARAMETER_COST * self.freed


class LinearMisfit:
    """The chi-square of a Workbench's lowest record under its bare linear model.

    freed: values that what was adopted chose; given: ModalModel without it, of whose change of
    the shapes two codes differ by a share (see nuisance.difference). Nuisances are marginalised.
    """

    def __init__(self, bench, freed=0, given=None):
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

    def p(self, chi_square=None, freed=0):
        """Return how probable so large a chi-square is by chance; that of the model where None."""
        chi_square = self.chi_square if chi_square is None else chi_square
        return float(stats.chi2.sf(chi_square, max(1, self.count - self.freed - freed)))

    @cached_property
    def mends(self):
        """Return the Mends, the likeliest first."""
        channels = self._channels
        found = [
            self._frequencies(),
            self._section(),
            *filter(None, starmap(self._length, parts(self.bench.config.structure).items())),
            *map(self._mode, range(self.modes)),
            *map(self._channel, channels),
            *map(self._gain, channels),
            *filter(None, map(self._direction, channels[~self._gauges[channels]])),
        ]
        # a place is read anew, which costs as much as all before: where nothing else mends it
        if not any(self._mended(mend) for mend in found if mend.kind != "channel"):
            found += self.places
        return sorted(found, key=lambda mend: mend.score)

    def _mended(self, mend):
        return self.p(mend.chi_square, mend.freed) > priors.SIGNIFICANT

    @cached_property
    def places(self):
        """Return the Mends by another place of the channels that disagree most."""
        channels = self._channels[~self._gauges[self._channels]]
        suspects = sorted(channels, key=lambda channel: self._channel(channel).chi_square)
        return [self._place(channel) for channel in suspects[:SUSPECTS]]

    @property
    def _gauges(self):
        """Return (channel,) bool: those of a strain, whose place and direction are not tried."""
        return gauges_of(self.bench.bare)

    @property
    def _channels(self):
        """Return (channel,): those that see a mode."""
        return np.flatnonzero(self.seen.any(axis=1))

    @property
    def modes(self):
        """Return the number of modes that are compared."""
        return len(self.measured.log_frequency)

    def _difference(self, simulated):
        """Return (values (value,), covariance) of modes and shapes; what a fit leaves of a channel
        is not of the model's modes, and is looked at by itself.
        """
        values, covariance, sensitivity = linear.difference(
            self.measured, simulated, self.seen, self.given
        )
        own = slice(len(values) - len(self.seen))
        return values[own], (covariance + sensitivity @ sensitivity.T)[own, own]

    def _whitened(self, values):
        return linalg.solve_triangular(self.factor, values, lower=True)

    def _along(self, kind, which, directions):
        """Return the Mend by values along directions (value, direction), amounts (direction,)."""
        amounts, _, rank, _ = linalg.lstsq(self._whitened(directions), self.white)
        left = self.white - self._whitened(directions) @ amounts
        return Mend(kind, which, amounts, float(left @ left), int(rank))

    def _frequencies(self):
        """Return the Mend of one factor for all frequencies."""
        found = self._along("frequencies", None, self._frequency(slice(None))[:, None])
        return replace(found, amount=float(found.amount[0]))

    def _frequency(self, chosen):
        """Return (value,): what ln of the frequency of the chosen modes changes."""
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
        """Return (value, row): what participations (row, mode) of a channel are among the
        values.
        """
        scale = self.measured.scale[channel]
        out = np.zeros((self.count, len(participations)))
        out[self._rows(channel)] = (participations / scale)[:, self.seen[channel]].T
        return out

    def _channel(self, channel):
        """Return the Mend of a channel whose participations are any."""
        return self._along(
            "channel", self._name(channel), np.eye(self.count)[:, self._rows(channel)]
        )

    def _gain(self, channel):
        """Return the Mend of a channel of another gain."""
        own = self._shapes(channel, self.simulated.participation[[channel]])
        found = self._along("gain", self._name(channel), own)
        return replace(found, amount=1.0 + float(found.amount[0]))

    def _direction(self, channel):
        """Return the Mend of a channel that looks along another direction at its place, None where
        the tube moves one way there.
        """
        modes = self.bench.measured_fit.modes
        moving = self._moving(self._stated(channel))[:, modes]
        three = self._shapes(channel, moving * self.bench.bare.drive_shapes[modes, 0])
        size = linalg.svdvals(self._whitened(three))
        if size[1] <= ONE_WAY * size[0]:
            return None
        own = self._shapes(channel, self.simulated.participation[[channel]])[:, 0]
        rest = self.white + self._whitened(
            own
        )  # measured, without what the model gives the channel
        amounts, *_ = linalg.lstsq(self._whitened(three), rest, cond=ONE_WAY)
        left = rest - self._whitened(three) @ amounts
        return Mend(
            "direction", self._name(channel), amounts / linalg.norm(amounts), float(left @ left), 2
        )

    def _place(self, channel):
        """Return the Mend of a channel at another place along the tube, read anew from there."""
        arcs = np.linspace(0.0, self._line.length, TRIED)
        far = _farness(self.bench, channel, self._moving(arcs))
        there = self._read_at(channel, arcs[np.argmin(far)])
        arcs = there._stated(channel) + np.linspace(-NEARBY_M, NEARBY_M, NEARBY)
        arcs = arcs[(arcs >= 0.0) & (arcs <= self._line.length)]
        chi_square = [there._moved_to(channel, arc) for arc in arcs]
        best = int(np.argmin(chi_square))
        moved = float(arcs[best] - self._stated(channel))
        return Mend("place", self._name(channel), moved, chi_square[best], 1, there.left)

    def _moved_to(self, channel, arc):
        """Return the chi-square with a channel at an arc length in m, its reading as it is."""
        modes, chain = self.bench.measured_fit.modes, self.bench.measuring
        gain = 1.0 if chain is None else chain.gain[channel] / chain.force_gain
        direction = self.bench.bare.sensor_directions[channel]
        shape = direction @ self._moving(arc)[:, modes] * self.bench.bare.drive_shapes[modes, 0]
        rows = self.simulated.participation.copy()
        rows[channel] = gain * shape
        return self._chi_square(replace(self.simulated, participation=rows))

    def _chi_square(self, simulated):
        """Return the chi-square under another Reading."""
        values, covariance = self._difference(simulated)
        factor = linalg.cholesky(covariance, lower=True)
        white = linalg.solve_triangular(factor, values, lower=True)
        return float(white @ white)

    def _section(self):
        """Return the Mend of a tube of another mass per metre and bending stiffness all along: one
        factor for the frequencies, one for all responses.
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
        """Return the Mend of a tube with some lengths times a factor, None where such a tube can
        not be built.
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
        """Return the Reading of a checked configuration with lengths, by their keys, times a
        factor.
        """
        values = scaled(config.model_dump(mode="json"), keys, factor)
        structure = type(config.structure).model_validate(values["structure"])
        points = Moved(config.structure, structure)
        campaign = points.campaign(self.bench.campaign)
        model = linearised(attach(check_config(points.values(values), "model"), campaign))
        modes = matched(model, self.measured.log_frequency, self.measured.participation)
        return linear.gained(linear.reading_of_model(model, modes), self.bench.measuring)

    def _read_at(self, channel, arc):
        """Return the LinearMisfit with a channel at an arc length in m, read anew."""
        points = self.bench.campaign["channel_point"].astype(float).copy()
        points[channel] = self._line.position(arc)
        bench = self.bench.again(self.bench.campaign.assign(channel_point=points))
        bench.followed = True  # with the other channels as they are, modes are found from the model
        return LinearMisfit(bench, self.freed, self.given_model)

    def place(self, mend):
        """Return (3,) m the place that a Mend moves its channel to."""
        channel = self.bench.signals.names.index(mend.which)
        return self._line.position(self._stated(channel) + mend.amount)

    def _name(self, channel):
        return self.bench.signals.names[channel]

    @cached_property
    def _line(self):
        return build_centreline(self.bench.config.structure)

    def _stated(self, channel):
        """Return the arc length in m at which a channel is stated to be."""
        name = self._name(channel)
        return self._line.locate(self.bench.bare.sensor_positions[channel], name)

    @cached_property
    def _moving(self):
        """Return the spline over arc length in m of displacements (direction, mode) along x, y, z
        of all modes.
        """
        campaign, arcs = self.bench.campaign, np.linspace(0.0, self._line.length, ALONG)
        points = np.repeat([self._line.position(arc) for arc in arcs], 3, axis=0)
        there = campaign.drop_dims("channel").assign(
            channel_point=(("channel", "xyz"), points),
            channel_direction=(("channel", "xyz"), np.tile(np.eye(3), (ALONG, 1))),
            channel_name=("channel", [f"along_{number}" for number in range(len(points))]),
            channel_kind=("channel", ["displacement"] * len(points)),
        )
        model = linearised(attach(check_config(self.bench.values, "model"), there))
        # one sign for a mode in both models: a mode is itself times -1
        sign = np.sign(np.sum(model.drive_shapes * self.bench.bare.drive_shapes, axis=1))
        shapes = (model.sensor_shapes * np.where(sign == 0.0, 1.0, sign)[:, None]).T
        return interpolate.CubicSpline(arcs, shapes.reshape(ALONG, 3, -1))


def _farness(bench, channel, shapes):
    """Return (place,): how far the lines of a channel are from those that the model gives at places
    of displacements (place, direction, mode), with the modes as the other channels show them.
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
    """Return a ModalModel with sensors of shapes (mode, sensor) alone; where they are plays no
    part.
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
