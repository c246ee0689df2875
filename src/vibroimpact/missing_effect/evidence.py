"""How probable the measurement is under an explanation, whatever its parameters, and under
something that no explanation holds.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp
from scipy.stats import qmc

from . import constants
from .effect_directions import EffectDirections
from .null import Null
from .trials import AnyEmulator

SAMPLES = 256
NEAR = 128  # samples about the best so far
SPREAD = 0.06  # of the searched range: of those
FAR = 1.0e6  # of log likelihood


@dataclass(frozen=True)
class Fit:
    """What a Trial says.

    promised: log evidence against nothing; by_law (law,): the same by each of constants.LAWS, with
    its prior; unit (parameter,) where least is expected to be left; samples (sample, parameter),
    even ones first, with weight (sample,): the posterior, open_weight (sample,): of where least may
    be left, and density (sample,): of the draw; mean
    (value,) the change of the run nearest to the measurement and left: chi-square that remains
    there; not_shown: what of the log evidence no run shows, by how much more likely the measurement
    is at the best sample than at the best run; takes: chi-square that is expected to be taken away
    at unit, may_take: that may be anywhere, by what the emulator does not know; doubt: standard
    deviation of the log evidence by the scatter of the runs near the nearest.
    """

    promised: float
    by_law: np.ndarray
    unit: np.ndarray
    samples: np.ndarray
    weight: np.ndarray
    open_weight: np.ndarray
    density: np.ndarray
    mean: np.ndarray
    left: float
    not_shown: float
    takes: float
    may_take: float
    doubt: float

    @property
    def log_evidence(self) -> float:
        """Return what runs show of the log evidence: an emulator may promise more than there is."""
        return self.promised - self.not_shown


def fit(
    emulator: AnyEmulator, count: int, null: Null, start: np.ndarray | None = None, seed: int = 3
) -> Fit:
    """Return the Fit of an Emulator of `count` parameters against a Null; start (parameter,): where
    the answer is near, None.
    """
    first = qmc.Sobol(count, seed=seed).random(SAMPLES)
    if start is not None:
        first[0] = start
    even = Likelihoods.of(emulator, first, null)
    best = first[np.argmax(even.over_laws)]
    near = np.clip(
        best + SPREAD * np.random.default_rng(seed).standard_normal((NEAR, count)), 0.0, 1.0
    )
    about = Likelihoods.of(emulator, near, null)
    density = _proposal(near, best)
    by_law = even.evidence(about, density)
    samples = np.vstack([first, near])
    chances = np.append(even.over_laws, about.over_laws)
    # not where the likelihood is largest: where little is known, and far out, where laws may differ
    # by more, it is wide
    expected = np.append(even.expected, about.expected)
    unit = samples[np.argmin(expected)]
    drawn = np.log(np.append(np.ones(SAMPLES), np.maximum(density, 1.0)))
    weight = chances - drawn
    open_weight = -0.5 * np.append(even.may_be_left, about.may_be_left) - drawn
    mean, variance = emulator(emulator.run)
    rest = null.measured - mean @ emulator.directions
    left = np.sum(rest**2, axis=1)
    nearest = int(np.argmin(left))
    shown = Likelihoods.of(emulator, emulator.run, null).over_laws.max()
    chi_square = float(null.measured @ null.measured)
    least = float(min(even.may_be_left.min(), about.may_be_left.min()))
    return Fit(
        float(logsumexp(by_law)),
        by_law,
        unit,
        samples,
        np.exp(weight - logsumexp(weight)),
        np.exp(open_weight - logsumexp(open_weight)),
        np.append(np.ones(SAMPLES), density),
        null.measured - rest[nearest],
        float(left[nearest]),
        max(0.0, float(chances.max() - shown)),
        max(0.0, chi_square - float(expected.min())),
        max(0.0, chi_square - least),
        _doubt(emulator.directions @ rest[nearest], variance[nearest]),
    )


def _doubt(rest, variance):
    """Return the standard deviation of the log evidence where rest (direction,) is left by runs
    whose scatter has a variance (direction,): that of the square of rest.
    """
    return 0.5 * float(np.sqrt(np.sum(4.0 * variance * rest**2 + 2.0 * variance**2)))


@dataclass(frozen=True)
class Likelihoods:
    """chance (law, point): log likelihoods against nothing, with constants.LAWS' priors;
    allowed (point,): whether the change is seen and brings the model nearer to the measurement;
    seen (point,): whether it is; expected, may_be_left (point,): chi-square that is expected to be
    left, and least that may be.
    """

    chance: np.ndarray
    allowed: np.ndarray
    seen: np.ndarray
    expected: np.ndarray
    may_be_left: np.ndarray

    @classmethod
    def of(cls, emulator: AnyEmulator, units: np.ndarray, null: Null) -> "Likelihoods":
        """Return the Likelihoods at units (point, parameter).

        A change that does not bring the model nearer to the measurement is not allowed: it explains
        nothing, however wide its law is and however little is known of it. Of these it is only told
        which leaves less, as if its law were known; where others are allowed, not even that.
        """
        mean, variance = emulator(units)
        change = mean @ emulator.directions
        seen = np.sum(change**2, axis=1) > constants.SEEN
        rest = null.measured - change
        left = np.sum(rest**2, axis=1)
        allowed = seen & (left < null.measured @ null.measured)
        prior = np.log([prior for _, prior in constants.LAWS])
        chance = np.tile(prior[:, None], (1, len(change)))
        if allowed.any():
            scatter = variance[allowed] + emulator.excess
            for row, (law, _) in zip(chance, constants.LAWS, strict=True):
                row[allowed] += log_likelihood(
                    change[allowed], scatter, emulator.directions, null, law
                )
        else:
            chance -= 0.5 * left + null.chance
        along, open_ = emulator.open_along(units, emulator.directions, variance)
        may_be_left = left - hidden(rest @ along.T, open_)
        return cls(chance, allowed, seen, left + variance.sum(axis=1), may_be_left)

    @property
    def over_laws(self) -> np.ndarray:
        """Return (point,): whatever the law; far below all others where nothing is explained."""
        return logsumexp(self.chance, axis=0) - FAR * ~self.allowed

    def evidence(self, about: "Likelihoods", density: np.ndarray) -> np.ndarray:
        """Return (law,): log evidence over a prior that is flat where the effect is seen; about:
        Likelihoods of samples of a density (point,) about the best, which find a peak that even
        samples step over.
        """
        if not (self.allowed.any() or about.allowed.any()):
            return np.full(len(self.chance), -np.inf)
        even = np.where(self.allowed, self.chance, -np.inf)
        peak = np.where(about.allowed, about.chance - np.log(np.maximum(density, 1.0)), -np.inf)
        share = max(self.seen.mean(), 1.0 / SAMPLES)
        return np.maximum(
            logsumexp(even, axis=1) - np.log(SAMPLES), logsumexp(peak, axis=1) - np.log(NEAR)
        ) - np.log(share)


def hidden(rest: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Return by how much less chi-square may remain within two standard deviations of the emulator:
    rest, variance (..., direction).
    """
    near = np.maximum(np.abs(rest) - 2.0 * np.sqrt(variance), 0.0)
    return np.sum(rest**2 - near**2, axis=-1)


def _proposal(near, best):
    """Return (sample,): the density of samples about the best, per unit volume."""
    away = np.sum(((near - best) / SPREAD) ** 2, axis=1)
    return np.maximum(
        np.exp(-0.5 * away) / (np.sqrt(2.0 * np.pi) * SPREAD) ** near.shape[1], 1.0e-12
    )


def log_likelihood(
    change: np.ndarray, scatter: np.ndarray, directions: np.ndarray, null: Null, law: float
) -> np.ndarray:
    """Return (point,) the log likelihood, against nothing, of a change (point, value) with a
    variance scatter (point, direction) along orthonormal directions (direction, value): what runs
    do not show and what an explanation scatters by more than the null.

    The covariance is that of the null, this scatter, and what a law may differ by: a share `law` of
    each value, and LAW_COMMON as much of all values of a group of channels together.
    """
    count = len(directions)
    weight = 1.0 / (1.0 + (law * change) ** 2)
    rest = null.measured - change
    sd = np.sqrt(scatter)
    first, second = np.triu_indices(count)
    groups = [null.groups == group for group in np.unique(null.groups)]
    common = [constants.LAW_COMMON * law * change[:, own] for own in groups]
    inner = np.zeros((len(change), *[count + len(groups)] * 2))
    inner[:, first, second] = weight @ (directions[first] * directions[second]).T
    inner[:, second, first] = inner[:, first, second]
    inner[:, :count, :count] *= sd[:, :, None] * sd[:, None, :]
    along = np.zeros(inner.shape[:2])
    along[:, :count] = sd * ((weight * rest) @ directions.T)
    for number, (own, row) in enumerate(zip(groups, common, strict=True), start=count):
        weighted = weight[:, own] * row
        inner[:, :count, number] = sd * (weighted @ directions[:, own].T)
        inner[:, number, :count] = inner[:, :count, number]
        inner[:, number, number] = np.sum(weighted * row, axis=1)
        along[:, number] = np.sum(weighted * rest[:, own], axis=1)
    inner += np.eye(inner.shape[1])
    solved = np.linalg.solve(inner, along[..., None])[..., 0]
    square = np.sum(rest**2 * weight, axis=1) - np.sum(along * solved, axis=1)
    size = np.linalg.slogdet(inner)[1] - np.sum(np.log(weight), axis=1)
    return -0.5 * (square + size) - null.chance


class SomethingElse:
    """The likelihood of what looks like effects but is none that was tried."""

    def __init__(self, effects: EffectDirections, null: Null) -> None:
        self.null, self.along = null, effects.along
        self.share = (1.0 - constants.WHITE) * null.values * effects.share
        self.sizes = np.geomspace(*constants.SIZES, 24)

    def log_evidence(self, mean: np.ndarray) -> np.ndarray:
        """Return (...,) the log evidence against nothing that the measurement is mean (..., value)
        and something else.
        """
        rest = self.null.measured - mean
        along = rest @ self.along.T
        outside = np.sum(rest**2, axis=-1) - np.sum(along**2, axis=-1)
        rows = []
        for size in self.sizes:
            white = 1.0 + constants.WHITE * size**2
            inside = white + size**2 * self.share
            rows.append(
                np.sum(along**2 / inside + np.log(inside), axis=-1)
                + outside / white
                + (self.null.values - len(inside)) * np.log(white)
            )
        chance = -0.5 * np.array(rows) - self.null.chance
        return logsumexp(chance, axis=0) - np.log(len(self.sizes))

    def beside(self, found: Fit, emulator: AnyEmulator) -> float:
        """Return the log evidence that the measurement is an explanation's change, whatever its
        parameters, and something else: what its runs show of it.
        """
        mean, _ = emulator(found.samples)
        chance = self.log_evidence(mean @ emulator.directions)
        even, near = np.split(chance - np.log(found.density), [SAMPLES])
        promised = max(logsumexp(even) - np.log(SAMPLES), logsumexp(near) - np.log(NEAR))
        return float(promised - max(0.0, chance.max() - self.log_evidence(found.mean)))
