"""Checks of a campaign by its own records, without a model: changes that no record can have.

The gain of a channel is the response per force, line by line. From one level to the next contact
bends the gains; it does not turn all of them round, move them by one factor at every line, or give
one sensor the gains of another. Each function yields (record, channel or None, sentence).
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from vibroimpact.campaign.signals import CampaignSignals, transfer

from .linear_record import COHERENT, mean_coherence, mean_cosine

Found = Iterator[tuple[int, int | None, str]]

SPIKE, FEW = 20.0, 3  # times all but a few samples
ALONE = 0.05  # of a spike: its neighbours are smaller
UNRELATED = 0.05  # mean coherence: the force of another record leaves 0.025, rattling 0.25 or more
ENOUGH = 4.0  # lines on which two records both follow their force
FOLLOWED = 0.1  # product of the coherences of a line whose gains are compared
# Mean cosine of the phase: to every other record, and to one of them. Contact alone leaves 0.13 or
# more to the nearest record, and -0.59 at worst to the farthest.
TURNED, OPPOSITE = -0.3, -0.6
OTHER_UNIT, OF_ONE = np.log(4.0), np.log(5.0)  # least factor of a record; of one channel of it
LIKE_OTHER = 0.6  # distance to the gains of the other channel, over that to its own
APART = 0.25  # least distance to its own, 1 for opposite gains
FOLLOWS, SILENT = 0.25, 0.1  # mean coherence of a channel that moves with the force, and of another


@dataclass(frozen=True)
class Gains:
    """The gains of a record at its lines.

    frequency (line,): Hz. h1 (channel, line): response per force, each channel over its scale.
    logarithm (channel,): of the scale, SI per N.
    coherence (channel, line): less its bias. mean (channel,): over the lines.
    """

    frequency: np.ndarray
    h1: np.ndarray
    logarithm: np.ndarray
    coherence: np.ndarray
    mean: np.ndarray


def spike(signal: np.ndarray) -> int | None:
    """Return the sample of a signal (time,) that stands alone far beyond all others, or None."""
    size = np.abs(signal - np.median(signal))
    if size.size <= FEW or not size.any():
        return None
    at, rest = int(np.argmax(size)), np.partition(size, -FEW - 1)[-FEW - 1]
    beside = size[max(at - 1, 0) : at + 2].sum() - size[at]
    return at if size[at] > SPIKE * rest and beside < ALONE * size[at] else None


def copies(measured: CampaignSignals) -> Found:
    """Yield the channels of a record that are copies, and the records that are."""
    for record, response in enumerate(measured.response):
        for one, other in combinations(np.flatnonzero(response.any(axis=-1)), 2):
            if np.array_equal(response[one], response[other], equal_nan=True):
                yield (
                    record,
                    int(other),
                    f"{measured.channels[other]} and {measured.channels[one]} hold the same samples"
                    f" in record {measured.records[record]}: one of them was stored twice.",
                )
    for first, second in combinations(range(len(measured.records)), 2):
        pairs = [(each[first], each[second]) for each in (measured.force, measured.response)]
        size = min(pairs[0][0].shape[-1], pairs[0][1].shape[-1])
        if all(np.array_equal(a[:, :size], b[:, :size], equal_nan=True) for a, b in pairs):
            yield (
                second,
                None,
                f"Record {measured.records[second]} holds the samples of record"
                f" {measured.records[first]}: one of them was stored twice.",
            )


def contradictions(measured: CampaignSignals) -> Found:
    """Yield the records that contradict the others: no response to the force, reversed, in another
    unit, or with two channels swapped. Of several forces the first would have to drive all.
    """
    seen = ((record, _gains(measured, record)) for record in range(len(measured.records)))
    found = {record: gains for record, gains in seen if gains is not None}
    best = {record: float(gains.mean.max()) for record, gains in found.items()}
    most = max(best.values(), default=0.0)
    for record in [each for each in best if best[each] < UNRELATED and most > COHERENT]:
        del found[record]
        yield (
            record,
            None,
            f"No response follows {measured.forces[0]} in record {measured.records[record]} (mean"
            f" coherence {best[record]:.2f} at most, {most:.2f} in others): the force is that of"
            " another record, or clocks differ.",
        )
    for record in found:
        pairs = [_Pair(found[record], found[other]) for other in found if other != record]
        if not pairs:
            continue
        # Channels that are swapped seem reversed or scaled too; if all are reversed, many pairs
        # seem swapped.
        swapped = [*_swapped(measured, record, pairs)]
        turned = [*_reversed(measured, record, pairs)]
        if len(swapped) == 1 or not turned:
            yield from swapped
        if not swapped or len(swapped) > 1:
            yield from turned
        if not swapped:
            yield from _other_unit(measured, record, pairs)


def _gains(measured: CampaignSignals, record: int) -> Gains | None:
    """Return the Gains of a record, None if its spectra can not be averaged."""
    force, finite = measured.force[record][0], measured.finite(record)
    if not (np.isfinite(force).all() and force.any() and finite.any()):
        return None
    response = measured.response[record] * finite[:, None]
    largest = np.abs(response).max(axis=-1)
    scale = np.where(largest > 0.0, largest, 1.0)  # a square of 1e-200 is 0
    scaled = [np.zeros_like(each) for each in measured.response]
    scaled[record] = response / scale[:, None]
    spectra = transfer(replace(measured, response=scaled), record)
    if spectra is None:
        return None
    coherence = np.clip(spectra.coherence - 3.0 / spectra.averages, 0.0, 1.0)
    mean = np.where(largest > 0.0, mean_coherence(spectra), 0.0)
    return Gains(spectra.frequency, spectra.h1, np.log(scale), coherence, mean)


class _Pair:
    """The gains of a record against those of another at its lines that the other reaches."""

    def __init__(self, own: Gains, other: Gains) -> None:
        low, high = other.frequency[[0, -1]]
        kept = (own.frequency >= low) & (own.frequency <= high)
        lines = own.frequency[kept]
        self.h1, self.coherence = own.h1[:, kept], own.coherence[:, kept]
        self.other_h1, self.other_coherence = (
            np.array([np.interp(lines, other.frequency, row) for row in rows])
            for rows in (other.h1, other.coherence)
        )
        self.logarithms, self.means = (own.logarithm, other.logarithm), (own.mean, other.mean)

    def weights(self, channel: int, other: int) -> np.ndarray:
        """Return (line,) the product of the coherences of a channel and one in the other record."""
        return self.coherence[channel] * self.other_coherence[other]

    @cached_property
    def compared(self) -> list[int]:
        """Return the channels that follow their force on enough lines of both records."""
        return [
            channel
            for channel in range(len(self.h1))
            if self.weights(channel, channel).sum() > ENOUGH
        ]

    def turn(self, channel: int) -> float:
        """Return the mean cosine of the phase of a channel between the two records."""
        own, other = self.h1[channel], self.other_h1[channel]
        return mean_cosine(own, other, self.weights(channel, channel))

    @cached_property
    def factors(self) -> dict[int, float]:
        """Return {channel: logarithm of its gains over those in the other record}, the median."""
        tiny = np.finfo(float).tiny
        found = {}
        for channel in self.compared:
            ratio = np.log(np.maximum(np.abs(self.h1[channel]), tiny))
            ratio -= np.log(np.maximum(np.abs(self.other_h1[channel]), tiny))
            followed = self.weights(channel, channel) > FOLLOWED
            own, other = self.logarithms
            if followed.any():
                found[channel] = float(np.median(ratio[followed]) + own[channel] - other[channel])
        return found

    def apart(self, channel: int) -> float:
        """Return the factor of a channel over that of the others, in logarithm: 0 if another one
        has changed more, or there is none.
        """
        others = [factor for each, factor in self.factors.items() if each != channel]
        own = self.factors.get(channel, 0.0)
        if not others or abs(own) < max(map(abs, others)):
            return 0.0
        return own - float(np.median(others))

    def distance(self, channel: int, other: int) -> float:
        """Return the distance of the gains of a channel from those of one in the other record: 0
        for equal, 1 for opposite ones.
        """
        shift = self.logarithms[0][channel] - self.logarithms[1][other]
        one, two = self.h1[channel] * np.exp(np.clip(shift, -300.0, 300.0)), self.other_h1[other]
        weights = self.weights(channel, other)
        if weights.sum() < ENOUGH:
            return 1.0
        size = np.maximum(np.abs(one) + np.abs(two), np.finfo(float).tiny)
        return float(np.average(np.abs(one - two) / size, weights=weights))


def _reversed(measured: CampaignSignals, record: int, pairs: list[_Pair]) -> Found:
    compared = {channel for pair in pairs for channel in pair.compared}
    cosines = {
        channel: [pair.turn(channel) for pair in pairs if channel in pair.compared]
        for channel in sorted(compared)
    }
    turned = {
        channel: min(all_of)
        for channel, all_of in cosines.items()
        if max(all_of) < TURNED and min(all_of) < OPPOSITE
    }
    name, against = measured.records[record], _against(pairs)
    if len(turned) == len(cosines) > 1:
        yield (
            record,
            None,
            f"All responses of record {name} are reversed against {measured.forces[0]} and"
            f" {against} (mean cosine of the phase {max(turned.values()):.2f}): the polarity of the"
            " force or of all sensors was another.",
        )
        return
    for channel, cosine in turned.items():
        yield (
            record,
            channel,
            f"{measured.channels[channel]} is reversed in record {name} against {against} (mean"
            f" cosine of the phase {cosine:.2f}): its polarity was another.",
        )


def _other_unit(measured: CampaignSignals, record: int, pairs: list[_Pair]) -> Found:
    name, against = measured.records[record], _against(pairs)
    shifts = [float(np.median(list(pair.factors.values()))) for pair in pairs if pair.factors]
    if shifts and (shift := min(shifts, key=abs)) and abs(shift) > OTHER_UNIT:
        yield (
            record,
            None,
            f"The responses of record {name} are {np.exp(shift):.3g} times those of {against} per"
            f" newton of {measured.forces[0]}, at every frequency: another unit or gain of the"
            " force or of all sensors.",
        )
        return
    for channel in range(len(measured.channels)):
        apart = [pair.apart(channel) for pair in pairs]
        if abs(factor := min(apart, key=abs)) > OF_ONE:
            yield (
                record,
                channel,
                f"{measured.channels[channel]} is {np.exp(factor):.3g} times as large relative to"
                f" the other channels in record {name} as in {against}: another unit or gain of its"
                " amplifier.",
            )


def _swapped(measured: CampaignSignals, record: int, pairs: list[_Pair]) -> Found:
    for one, other in combinations(range(len(measured.channels)), 2):
        if all(_is_swap(pair, one, other) for pair in pairs):
            yield (
                record,
                one,
                f"{measured.channels[one]} and {measured.channels[other]} are swapped in record"
                f" {measured.records[record]} against {_against(pairs)}: each has the gains that"
                " the other has there.",
            )


def _is_swap(pair: _Pair, one: int, other: int) -> bool:
    """Whether two channels of a record have each the gains of the other in another record."""
    here, there = pair.means
    for follows, silent in ((one, other), (other, one)):
        if min(there[follows], here[silent]) > FOLLOWS:
            if max(there[silent], here[follows]) < SILENT:
                return True
    own = pair.distance(one, one), pair.distance(other, other)
    cross = pair.distance(one, other) + pair.distance(other, one)
    return min(own) > APART and cross < LIKE_OTHER * sum(own)


def _against(pairs: list[_Pair]) -> str:
    return "the others" if len(pairs) > 1 else "the other"
