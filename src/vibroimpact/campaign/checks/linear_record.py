"""Checks of a linear record without a model: coherence, delays, swapped and reversed channels.

A structure with real modes moves in phase or in opposite phase with the force away from its
resonances. Twice the phase of the response per force is then zero on most lines. A delay adds a
phase in proportion to frequency, in its own channel alone.
"""

from collections.abc import Sequence

import numpy as np

from vibroimpact.campaign.file import SAME_POINT_M
from vibroimpact.campaign.signals import CampaignSignals, Transfer
from vibroimpact.identify.lscf import NormalEquations
from vibroimpact.io.units import TIME_DERIVATIVES

ALIGNED, ACROSS = 0.7, 0.3  # |cosine| with the force
COHERENT, INCOHERENT, NO_CAUSE = 0.8, 0.35, 0.1
LONGEST_DELAY_SAMPLES, DELAY_STEP = 40.0, 0.05
# Least score of a channel after its delay is removed. Below it the modes are not real, or the
# response is not linear.
REAL_ENOUGH = 0.6
SEEN_RAD, SEEN_SAMPLES = 0.15, 0.3  # least reported delay: its phase at the highest line; samples
OUTSHINES = 10.0  # power of a channel across the force over one along it that makes a swap likely
WOKEN = 2.0  # times its RMS in the lowest record that a dead channel does not reach
SAME_SIGN = 0.7
WELL_FITTED = 0.5  # relative error of real modes that say something of a delay
LAG_ORDER = 12  # of the estimator of poles that a delay is held against


def mean_coherence(spectra: Transfer) -> np.ndarray:
    """Return (channel,) the mean coherence over the lines, less its bias.

    The bias is the coherence that the finite number of averages gives to unrelated signals.
    """
    bias = 1.0 / spectra.averages
    return np.clip((spectra.coherence.mean(axis=-1) - bias) / (1.0 - bias), 0.0, 1.0)


def mean_cosine(one: np.ndarray, other: np.ndarray, weights: np.ndarray) -> float:
    """Return the weighted mean cosine of the phase between two complex responses (line,)."""
    product = one * other.conj()
    cosine = product.real / np.maximum(np.abs(product), np.finfo(float).tiny)
    return float(np.average(cosine, weights=weights))


def channel_delays(
    spectra: Transfer, kinds: Sequence[str], rate: float, finite: np.ndarray
) -> tuple[dict[int, float], float | None]:
    """Return ({channel: lag in samples}, common lag in samples or None).

    kinds (channel,): texts.
    rate: Hz.
    finite (channel,): whether a channel is judged; a contact force never is.

    The lags of the channels are relative to the others; the common lag is that of all channels
    behind the force. The lag tau of a channel maximises sum coherence * Re((h/|h|)² exp(2i omega
    tau)), which is 1 for real modes without noise; a velocity is first turned by a quarter period.
    A lag is reported if it explains half of the distance to 1, if its phase is large
    enough to be seen, and if real modes fit no better without it.
    """
    unit = spectra.h1 / np.maximum(np.abs(spectra.h1), np.finfo(float).tiny)
    squared = unit**2 * np.where(np.array(kinds) == "velocity", -1.0, 1.0)[:, None]
    finite = finite & (np.array(kinds) != "contact_force")
    total = spectra.coherence.sum(axis=-1, keepdims=True)
    weights = spectra.coherence / np.maximum(total, np.finfo(float).tiny)
    lags = np.arange(-LONGEST_DELAY_SAMPLES, LONGEST_DELAY_SAMPLES + DELAY_STEP, DELAY_STEP)
    turns = np.exp(4j * np.pi * np.outer(spectra.frequency, lags / rate))
    score = np.real((weights * squared) @ turns)
    best = score.max(axis=-1)
    trusted = np.flatnonzero(finite & (best > REAL_ENOUGH) & (mean_coherence(spectra) > INCOHERENT))
    if trusted.size == 0:
        return {}, None
    found = lags[np.argmax(score, axis=-1)]
    smallest = max(SEEN_SAMPLES, SEEN_RAD * rate / (2.0 * np.pi * spectra.frequency[-1]))
    suspect = [int(index) for index in trusted if abs(found[index]) > smallest]
    found[_not_delayed(spectra, kinds, suspect, found / rate)] = 0.0
    common = float(np.median(found[trusted]))
    here, zero = (int(np.argmin(np.abs(lags - lag))) for lag in (common, 0.0))
    apart = {
        int(index): float(found[index] - common)
        for index in trusted
        if abs(found[index] - common) > smallest and _explains(score[index, here], best[index])
    }
    together = score[trusted].mean(axis=0)
    late = abs(common) > smallest and _explains(together[zero], together[here])
    return apart, common if late else None


def _not_delayed(
    spectra: Transfer, kinds: Sequence[str], channels: list[int], lags: np.ndarray
) -> list[int]:
    """Return those of the channels that real modes fit better without the lag (channel,) in s.

    Damping that couples two modes turns the phase of a small response in proportion to frequency
    too. The poles are those of the estimator LSCF of all channels, the residues real, with a
    constant flexibility and inertia added; errors are relative, line by line.
    """
    order = min(LAG_ORDER, spectra.frequency.size // 4)
    if not channels or order < 2:
        return []
    size = np.sqrt(np.mean(np.abs(spectra.h1) ** 2, axis=1, keepdims=True))
    scaled = spectra.h1 / np.maximum(size, np.finfo(float).tiny)
    poles = NormalEquations(spectra.frequency, scaled[:, None, :], order).poles(order)[0]
    poles = poles[poles.real < 0.0][:, None]
    s = 2j * np.pi * spectra.frequency
    modes = 1.0 / (s**2 - 2.0 * poles.real * s + np.abs(poles) ** 2)

    def error(channel: int, lag: float) -> float:
        derived = s ** TIME_DERIVATIVES.get(kinds[channel], 0)
        response = spectra.h1[channel] * np.exp(s * lag)
        weight = np.sqrt(spectra.coherence[channel]) / np.maximum(np.abs(response), 1e-300)
        lines = np.vstack([modes, np.ones_like(s), s**-2.0]) * derived * weight
        columns = np.hstack([lines.real, lines.imag]).T
        columns /= np.linalg.norm(columns, axis=0)
        target = np.hstack([(response * weight).real, (response * weight).imag])
        left = target - columns @ np.linalg.lstsq(columns, target)[0]
        return float(np.linalg.norm(left) / np.linalg.norm(target))

    return [
        each
        for each in channels
        if error(each, 0.0) < min(WELL_FITTED, error(each, float(lags[each])))
    ]


def _explains(without: float, with_it: float) -> bool:
    """Whether a lag raises the score by more than half of the distance to 1."""
    return with_it - without > 0.5 * (1.0 - with_it)


def alignment(signals: CampaignSignals) -> np.ndarray:
    """Return (channel,) |cosine| between the direction of a channel and that of force channel 0.

    NaN if either direction is zero.
    """
    force = signals.force_directions[0]
    lengths = np.linalg.norm(signals.directions, axis=1) * np.linalg.norm(force)
    return np.abs(signals.directions @ force) / np.where(lengths > 0.0, lengths, np.nan)


def swap_hints(signals: CampaignSignals, spectra: Transfer) -> list[tuple[int, int | None]]:
    """Return pairs (channel along the force, channel across it or None) whose names seem swapped.

    A channel along the force is suspect if it is incoherent although most others along the force
    are coherent. A contact force is not: there is none until the structure touches. Its partner is
    a coherent channel across the force, the one at the same point if there is one, of the same kind
    if there is one. Without a partner, one channel that follows is no evidence against another.
    """
    coherence, along = mean_coherence(spectra), alignment(signals)
    # if only the strong lines of a channel are above its noise, its mean coherence is low
    follows = np.maximum(coherence, spectra.following)
    along = np.where(np.array(signals.kinds) == "contact_force", np.nan, along)
    following = np.sum((along > ALIGNED) & (coherence > COHERENT))
    silent = np.flatnonzero((along > ALIGNED) & (follows < INCOHERENT))
    loud = np.flatnonzero((along < ACROSS) & (coherence > COHERENT))
    hints: list[tuple[int, int | None]] = []
    if following < silent.size:
        return hints
    for index in silent:
        alike = [other for other in loud if signals.kinds[other] == signals.kinds[index]]
        least = OUTSHINES * spectra.power[index]
        louder = [other for other in alike if spectra.power[other] > least]
        rivals = louder if alike else loud.tolist()
        beside = [
            other
            for other in rivals
            if np.linalg.norm(signals.points[other] - signals.points[index]) < SAME_POINT_M
        ]
        partners = beside or rivals
        if partners or following > 1:
            hints.append((int(index), int(partners[0]) if partners else None))
    return hints


def wakes(signals: CampaignSignals, channel: int) -> bool:
    """Return whether a channel that is still in the lowest record moves in another: it is on a body
    that contact alone moves. What a dead channel records does not grow with the load.
    """
    lowest = signals.lowest()
    if lowest is None:
        return False
    rms = [np.nan_to_num(response[channel]).std() for response in signals.response]
    return bool(max(rms) > WOKEN * rms[lowest])


def reversed_hint(signals: CampaignSignals, spectra: Transfer) -> int | None:
    """Return the channel that moves against all others below the first resonance, or None.

    It is reported only of four or more motions along the force, when all are coherent and all
    others are in phase with one another.
    """
    orders = np.array([TIME_DERIVATIVES.get(kind, np.nan) for kind in signals.kinds])
    force = signals.force_directions[0]
    along = signals.directions @ force / max(np.linalg.norm(force), 1e-12)
    usable = np.flatnonzero((np.abs(along) > ALIGNED) & np.isfinite(orders))
    if usable.size < 4 or mean_coherence(spectra)[usable].min() < COHERENT:
        return None
    # Up to just past the first clear peak of the summed receptance, all channels move as the first
    # mode does.
    differentiated = (2j * np.pi * spectra.frequency) ** orders[usable, None]
    receptance = spectra.h1[usable] * np.sign(along[usable])[:, None] / differentiated
    size = np.sum(np.abs(receptance) ** 2, axis=0)
    part = receptance[:, : max(int(np.argmax(size)) + 1, 3)]
    lengths = np.maximum(np.linalg.norm(part, axis=1), 1e-300)
    largest = int(np.argmax(lengths))
    phase = np.real(part @ part[largest].conj()) / (lengths * lengths[largest])
    against = np.flatnonzero(phase < -SAME_SIGN)
    with_it = np.flatnonzero(phase > SAME_SIGN)
    if against.size + with_it.size < usable.size or min(against.size, with_it.size) != 1:
        return None
    return int(usable[against[0] if against.size == 1 else with_it[0]])
