"""Check of the lowest record for power that is not a linear response to the measured force, by
channel and band.

The residual of the fit of modes may contain modes that the model lacks. So everything that is a
smooth function of frequency times the force, and the smooth spectrum of the transients at the ends,
is removed from it in blocks of neighbouring lines. The rest is noise, another source, or a
nonlinear response (local polynomial method: R. Pintelon, J. Schoukens, System Identification, 2012,
chapter 7).
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from . import priors
from .modal_lines import RESIDUAL_SHARE
from .mode_identification import unexplained_lines
from .workbench import Workbench

# lines of a block, and values fitted to them: a straight line for the force and one for the ends
BLOCK = 9
FREE = 4
BANDS = 12
FACTOR = 2.0  # times the power by noise and by RESIDUAL_SHARE: less is no finding


@dataclass(frozen=True)
class OtherSource:
    """A band of a channel with power that is not a linear response to the measured force.

    channel: its index. band_Hz. share: of the power there. factor: over what noise explains.
    p: of the most significant part of the band, corrected for the number of bands and channels.
    """

    channel: int
    band_Hz: tuple[float, float]
    share: float
    factor: float
    p: float


def other_sources(bench: Workbench) -> list[OtherSource]:
    """Return [OtherSource] of the lowest record of a Workbench, the largest factor first."""
    record, signals = bench.linear_record, bench.signals
    measured, rest = _lines(bench)
    left = np.sum(np.abs(rest) ** 2, axis=-1)
    power = np.sum(np.abs(measured) ** 2, axis=-1)
    edges = np.geomspace(*signals.band_Hz, BANDS + 1)
    band = np.digitize(blocks(record.frequency).mean(axis=-1), edges[1:-1])
    inside = (band == np.arange(BANDS)[:, None]).astype(float).T
    free = inside.sum(axis=0) * (BLOCK - FREE)  # complex degrees of freedom
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


def incoherent_rest(bench: Workbench) -> tuple[np.ndarray, np.ndarray]:
    """Return ((channel, block, BLOCK), (channel, block)): the lines of the lowest record of a
    Workbench that are not a linear response to the force, and their RMS by noise and by
    RESIDUAL_SHARE.
    """
    measured, rest = _lines(bench)
    noise = bench.signals.noise_in_band[:, None] ** 2 / len(bench.linear_record.lines)
    power = np.mean(np.abs(measured) ** 2, axis=-1)
    return rest, np.sqrt(noise + RESIDUAL_SHARE**2 * power + 1.0e-300)


def _lines(bench):
    """Return (measured, rest), each (channel, block, BLOCK): the lines of the lowest record, and
    the part that is not a linear response to the force.
    """
    record, signals = bench.linear_record, bench.signals
    responses = bench.valid(signals.response[signals.lowest])
    measured, rest = unexplained_lines(
        record, responses, bench.bare, bench.measured_fit, signals.kinds
    )
    force = record.spectra(bench.valid(signals.force[signals.lowest])[0])
    return blocks(measured), incoherent(force, rest)


def blocks(lines: np.ndarray) -> np.ndarray:
    """Return (..., block, BLOCK): lines (..., line) in blocks of neighbours, without the last few
    that fill no block.
    """
    count = lines.shape[-1] // BLOCK
    return lines[..., : count * BLOCK].reshape(*lines.shape[:-1], count, BLOCK)


def incoherent(force: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Return (channel, block, BLOCK): lines (channel, line) without a smooth function of frequency
    times those of the force (line,), and without a smooth function alone.
    """
    force, lines = blocks(force), blocks(lines)
    along = np.linspace(-1.0, 1.0, BLOCK)
    one = np.ones_like(force)
    known = np.stack([force, along * force, one, along * one], axis=-1)
    known, _ = np.linalg.qr(known)
    return lines - np.einsum("bij,bkj,cbk->cbi", known, known.conj(), lines)
