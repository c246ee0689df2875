"""What of the lowest record is no linear response to the measured force, by channel and band.

What the fit of modes leaves is cleared, in blocks of neighbouring lines, of all that is a smooth
function of frequency times the force, and of the smooth lines of a start and an end: modes that the
model does not have are linear too. The rest is noise, another source, or a structure that is not
linear (local polynomial method: R. Pintelon, J. Schoukens, System Identification, 2012, chapter 7).
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from vibroimpact.discrepancy import priors

from .modal_fit import RESIDUAL_SHARE
from .mode_identification import unexplained_lines

BLOCK = 9  # lines: fitted by 4 values, a straight line for the force and one for the ends
FREE = 4
BANDS = 12
FACTOR = 2.0  # times what noise and two codes leave: less is no finding


@dataclass(frozen=True)
class OtherSource:
    """A band of a channel with power that the measured force does not explain linearly.

    channel: its number; band_Hz; share: of the power there; factor: over what noise explains; p:
    of the most significant band, for all bands and channels that were looked at.
    """

    channel: int
    band_Hz: tuple[float, float]
    share: float
    factor: float
    p: float


def other_sources(bench):
    """Return [OtherSource] of the lowest record of a Workbench, what is
    farthest beyond noise first."""
    record, signals = bench.linear_record, bench.signals
    measured, rest = _lines(bench)
    left = np.sum(np.abs(rest) ** 2, axis=-1)
    power = np.sum(np.abs(measured) ** 2, axis=-1)
    edges = np.geomspace(*signals.band_Hz, BANDS + 1)
    band = np.digitize(blocks(record.frequency).mean(axis=-1), edges[1:-1])
    inside = (band == np.arange(BANDS)[:, None]).astype(float).T
    free = inside.sum(axis=0) * (BLOCK - FREE)  # complex values that are left to chance
    noise = signals.noise_in_band[:, None] ** 2 / len(record.lines) * free
    left, power = left @ inside, power @ inside
    expected = noise + RESIDUAL_SHARE**2 * power * (1.0 - FREE / BLOCK) + 1.0e-300
    p = stats.chi2.sf(2.0 * free * left / expected, 2.0 * np.maximum(free, 1.0)) * left.size
    marked = (p < priors.SIGNIFICANT) & (left > FACTOR * expected) & (free > 0)
    found = []
    for channel, own in enumerate(marked):
        for run in np.split(np.arange(BANDS), np.flatnonzero(np.diff(own)) + 1):
            if own[run[0]]:
                beyond = (left - expected)[channel, run].sum() / (1.0 - FREE / BLOCK)
                found.append(
                    OtherSource(
                        channel,
                        (float(edges[run[0]]), float(edges[run[-1] + 1])),
                        float(min(1.0, beyond / power[channel, run].sum())),
                        float(left[channel, run].sum() / expected[channel, run].sum()),
                        float(p[channel, run].min()),
                    )
                )
    return sorted(found, key=lambda row: -row.factor)


def incoherent_rest(bench):
    """Return ((channel, block, BLOCK), (channel, block)): what is no linear response to the force
    in the lowest record of a Workbench, and the RMS that noise and two codes leave of a line.
    """
    measured, rest = _lines(bench)
    noise = bench.signals.noise_in_band[:, None] ** 2 / len(bench.linear_record.lines)
    power = np.mean(np.abs(measured) ** 2, axis=-1)
    return rest, np.sqrt(noise + RESIDUAL_SHARE**2 * power + 1.0e-300)


def _lines(bench):
    """Return (measured, rest), each (channel, block, BLOCK): the lines of the lowest record, and
    what of them is no linear response to the force.
    """
    record, signals = bench.linear_record, bench.signals
    responses = bench.valid(signals.response[signals.lowest])
    measured, rest = unexplained_lines(
        record, responses, bench.bare, bench.measured_fit, signals.kinds
    )
    force = record.spectra(bench.valid(signals.force[signals.lowest])[0])
    return blocks(measured), incoherent(force, rest)


def blocks(lines):
    """Return (..., block, BLOCK): neighbouring lines (..., line) side by side, the last few left
    out.
    """
    count = lines.shape[-1] // BLOCK
    return lines[..., : count * BLOCK].reshape(*lines.shape[:-1], count, BLOCK)


def incoherent(force, lines):
    """Return (channel, block, BLOCK): what lines (channel, line) have beside a smooth function of
    frequency times those of the force (line,), and beside one alone.
    """
    force, lines = blocks(force), blocks(lines)
    along = np.linspace(-1.0, 1.0, BLOCK)
    one = np.ones_like(force)
    known = np.stack([force, along * force, one, along * one], axis=-1)
    known, _ = np.linalg.qr(known)
    return lines - np.einsum("bij,bkj,cbk->cbi", known, known.conj(), lines)
