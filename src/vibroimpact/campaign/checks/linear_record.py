"""Checks that a linear record allows without a model: coherence, delays between channels, hints of
swapped or reversed channels.

A structure of real modes moves in phase or in opposite phase with the force away from its
resonances, so that twice the phase of the response per force is zero on most lines; a delay turns
it in proportion to frequency, in its own channel alone.
"""

from __future__ import annotations

import numpy as np

from vibroimpact.campaign.file import NEAR_M

ALIGNED, ACROSS = 0.7, 0.3  # |cosine| with the force
COHERENT, INCOHERENT, NO_CAUSE = 0.8, 0.35, 0.1
LONGEST_DELAY_SAMPLES, DELAY_STEP = 40.0, 0.05
# least agreement of twice the phase after the delay is taken out: below, modes are not real or
# nothing is linear
REAL_ENOUGH = 0.6
SEEN_RAD = 0.15  # phase of a delay at the highest line below which it is not told
SEEN_SAMPLES = 0.3
OUTSHINES = 10.0  # power of a channel across the force over one along it that makes a swap likely
SAME_SIGN = 0.7


def mean_coherence(spectra):
    """Return (channel,) the mean coherence over the lines, less what averages alone give to
    unrelated signals.
    """
    bias = 1.0 / spectra.averages
    return np.clip((spectra.coherence.mean(axis=-1) - bias) / (1.0 - bias), 0.0, 1.0)


def delays(spectra, kinds, rate, finite):
    """Return ({channel: samples} by which channels lag the others, samples by which all lag the
    force or None).

    The lag tau of a channel makes sum coherence * Re((h/|h|)² exp(2i omega tau)) largest, 1 for
    real modes without noise; a velocity is turned by a quarter first. It is told where it explains
    half of what is missing to 1, and where its phase can be seen. finite (channel,): judged.
    """
    unit = spectra.h1 / np.maximum(np.abs(spectra.h1), np.finfo(float).tiny)
    squared = unit**2 * np.where(np.array(kinds) == "velocity", -1.0, 1.0)[:, None]
    weights = spectra.coherence / np.maximum(
        spectra.coherence.sum(axis=-1, keepdims=True), np.finfo(float).tiny
    )
    lags = np.arange(-LONGEST_DELAY_SAMPLES, LONGEST_DELAY_SAMPLES + DELAY_STEP, DELAY_STEP)
    score = np.real(
        (weights * squared) @ np.exp(4j * np.pi * np.outer(spectra.frequency, lags / rate))
    )
    best = score.max(axis=-1)
    trusted = np.flatnonzero(finite & (best > REAL_ENOUGH) & (mean_coherence(spectra) > INCOHERENT))
    if trusted.size == 0:
        return {}, None
    found = lags[np.argmax(score, axis=-1)]
    smallest = max(SEEN_SAMPLES, SEEN_RAD * rate / (2.0 * np.pi * spectra.frequency[-1]))
    common = float(np.median(found[trusted]))
    here, zero = (int(np.argmin(np.abs(lags - lag))) for lag in (common, 0.0))
    apart = {
        int(index): float(found[index] - common)
        for index in trusted
        if abs(found[index] - common) > smallest and _explains(score[index, here], best[index])
    }
    together = score[trusted].mean(axis=0)
    return apart, (
        common if abs(common) > smallest and _explains(together[zero], together[here]) else None
    )


def _explains(without, with_it):
    """Whether a lag raises the score by half of what is missing to 1."""
    return with_it - without > 0.5 * (1.0 - with_it)


def alignment(measured):
    """Return (channel,) |cosine| between each channel's direction and that of force channel 0; NaN
    for a direction of zeros.
    """
    force = measured.force_directions[0]
    lengths = np.linalg.norm(measured.directions, axis=1) * np.linalg.norm(force)
    return np.abs(measured.directions @ force) / np.where(lengths > 0.0, lengths, np.nan)


def swap_hints(measured, spectra):
    """Return (channel along the force, channel across it or None) pairs whose names seem swapped,
    from coherence and power.

    Where most channels along the force follow it, one that does not, beside or while one across it
    does, looks like the other one.
    """
    coherence, along = mean_coherence(spectra), alignment(measured)
    following = (along > ALIGNED) & (coherence > COHERENT)
    silent = np.flatnonzero((along > ALIGNED) & (coherence < INCOHERENT))
    loud = np.flatnonzero((along < ACROSS) & (coherence > COHERENT))
    if following.sum() < max(2, silent.size):
        return []
    hints = []
    for index in silent:
        rivals = [
            other
            for other in loud
            if measured.kinds[other] == measured.kinds[index]
            and spectra.power[other] > OUTSHINES * spectra.power[index]
        ]
        beside = [
            other
            for other in rivals
            if np.linalg.norm(measured.points[other] - measured.points[index]) < NEAR_M
        ]
        partner = (beside or rivals or [None])[0]
        hints.append((int(index), None if partner is None else int(partner)))
    return hints


def reversed_hint(measured, spectra):
    """Return the channel that moves against all others below the first resonance, or None.

    Only told of four or more channels along the force, displacements and accelerations, all
    coherent, all others in phase with one another.
    """
    signs = np.array(
        [{"acceleration": -1.0, "displacement": 1.0}.get(kind, np.nan) for kind in measured.kinds]
    )
    force = measured.force_directions[0]
    along = measured.directions @ force / max(np.linalg.norm(force), 1e-12)
    usable = np.flatnonzero((np.abs(along) > ALIGNED) & np.isfinite(signs))
    if usable.size < 4 or mean_coherence(spectra)[usable].min() < COHERENT:
        return None
    # Up to just past the first clear peak of the summed receptance all moves as the first mode
    # does.
    omega = 2.0 * np.pi * spectra.frequency
    to_displacement = (
        np.where(signs[usable] < 0.0, 1.0, 0.0)[:, None] * (1.0 / omega**2 - 1.0) + 1.0
    )
    receptance = (
        spectra.h1[usable] * (signs[usable] * np.sign(along[usable]))[:, None] * to_displacement
    )
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
