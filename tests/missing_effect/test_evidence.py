"""Evidence against textbook results: normal laws, a peak in a flat prior, a Gaussian process."""

import numpy as np
import pytest
from scipy import integrate, stats
from scipy.stats import qmc

from tests.white_null import white_null
from vibroimpact.missing_effect import constants, evidence
from vibroimpact.missing_effect.effect_directions import EffectDirections
from vibroimpact.missing_effect.evidence import SomethingElse, fit, log_likelihood
from vibroimpact.missing_effect.trials import Emulator, PairEmulator, Trial

VALUES = 40
AXES = np.linalg.qr(np.random.default_rng(5).standard_normal((VALUES, VALUES)))[0].T


class Line:
    """A candidate of one parameter, not periodic."""

    periodic = ()


class Known:
    """An emulator of a change that is known: size times the parameter along one direction."""

    directions = AXES[:1]
    run = np.linspace(0.0, 1.0, 401)[:, None]

    def __init__(self, size, variance=0.0, excess=0.0):
        self.size, self.variance, self.excess = size, variance, np.array([excess])

    def __call__(self, unit):
        unit = np.atleast_2d(unit)
        return self.size * unit[:, :1], np.full((len(unit), 1), self.variance)

    def open_along(self, unit, directions, variance):
        return directions, variance


def likelihood(emulator, null, law=0.0):
    """The log likelihood at 0.7 of the range, against nothing."""
    mean, variance = emulator([[0.7]])
    change = mean @ emulator.directions
    return log_likelihood(change, variance + emulator.excess, emulator.directions, null, law)


def normal(covariance):
    return stats.multivariate_normal(np.zeros(VALUES), covariance)


def null_with(measured):
    return white_null(measured, groups=np.repeat([0, 1], VALUES // 2))


def trial_of(units, changes, noise):
    one_seed = [np.zeros((0, VALUES))] * len(units)
    return Trial(Line(), units, changes, np.full(len(units), noise), one_seed)


@pytest.mark.parametrize("law", [0.0, 0.3])
def test_likelihood_is_that_of_a_normal_law(law):
    measured = np.random.default_rng(1).standard_normal(VALUES) + 9.0 * AXES[0]
    emulator, null = Known(12.0, variance=4.0), null_with(measured)
    (chance,) = likelihood(emulator, null, law)
    change = 0.7 * 12.0 * AXES[0]
    covariance = np.eye(VALUES) + np.diag((law * change) ** 2) + 4.0 * np.outer(AXES[0], AXES[0])
    for group in (0, 1):
        common = constants.LAW_COMMON * law * change * (null.groups == group)
        covariance += np.outer(common, common)
    wanted = stats.multivariate_normal(change, covariance).logpdf(measured)
    nothing = normal(np.eye(VALUES)).logpdf(measured)
    assert chance == pytest.approx(wanted - nothing, abs=1.0e-8)


def test_own_scatter_counts_as_what_is_not_known():
    """A measurement far along the direction that its own seeds scatter along is not so unlikely."""
    null = null_with(20.0 * AXES[0])
    wanted = likelihood(Known(12.0, variance=3.0), null)
    assert likelihood(Known(12.0, excess=3.0), null) == pytest.approx(wanted)
    assert likelihood(Known(12.0), null) < wanted - 10.0


def test_evidence_is_the_integral_over_the_prior(monkeypatch):
    monkeypatch.setattr(constants, "LAWS", ((0.0, 1.0),))
    measured = np.random.default_rng(2).standard_normal(VALUES) + 14.0 * AXES[0]
    size, null = 30.0, null_with(measured)
    seen = np.sqrt(constants.SEEN) / size  # the prior is flat where the change is seen
    along = AXES[0] @ measured

    def chance(unit):
        gain = along * size * unit - 0.5 * (size * unit) ** 2
        return np.exp(gain) / (1.0 - seen)

    wanted = np.log(integrate.quad(chance, seen, 1.0, points=[along / size])[0])
    found = fit(Known(size), 1, null)
    assert found.log_evidence == pytest.approx(wanted, abs=0.15)
    assert found.unit[0] == pytest.approx(along / size, abs=0.02)
    assert found.left == pytest.approx(measured @ measured - along**2, rel=0.05)


def test_what_no_run_shows_is_not_evidence(monkeypatch):
    monkeypatch.setattr(constants, "LAWS", ((0.0, 1.0),))
    measured = np.random.default_rng(2).standard_normal(VALUES) + 14.0 * AXES[0]
    emulator = Known(30.0)
    shown = fit(emulator, 1, null_with(measured))
    emulator.run = np.array([[0.7]])  # off the answer, near 0.5
    promised = fit(emulator, 1, null_with(measured))
    assert promised.promised == pytest.approx(shown.promised)
    assert promised.left == pytest.approx(np.sum((measured - 0.7 * 30.0 * AXES[0]) ** 2), rel=0.1)
    lost = 0.5 * (promised.left - shown.left)
    assert promised.log_evidence == pytest.approx(shown.log_evidence - lost, abs=0.1)


def test_explanation_of_which_no_run_comes_nearer_is_none():
    """Whatever an emulator leaves open: it is run where it may be the answer, not believed."""
    measured = 14.0 * AXES[0]
    emulator = Known(30.0, variance=400.0)
    emulator.run = np.array([[1.0]])  # twice as far as what is measured
    found = fit(emulator, 1, null_with(measured))
    assert found.promised > 20.0 and found.log_evidence < -1.0e3
    assert found.may_take == pytest.approx(14.0**2)


def test_something_else_is_a_normal_law_of_unknown_size():
    random = np.random.default_rng(3)
    measured = 6.0 * random.standard_normal(VALUES)
    effects = EffectDirections(AXES[:3], np.full(3, 1.0 / 3.0))
    else_ = SomethingElse(effects, null_with(measured))
    alike = (1.0 - constants.WHITE) * VALUES / 3.0 * AXES[:3].T @ AXES[:3]
    looks = constants.WHITE * np.eye(VALUES) + alike
    rows = [normal(np.eye(VALUES) + size**2 * looks).logpdf(measured) for size in else_.sizes]
    nothing = normal(np.eye(VALUES)).logpdf(measured)
    wanted = np.logaddexp.reduce(np.array(rows) - nothing) - np.log(len(rows))
    assert else_.log_evidence(np.zeros(VALUES)) == pytest.approx(wanted, abs=1.0e-8)


def test_emulator_returns_runs_and_tells_what_it_lacks():
    units = np.array([[0.1], [0.3], [0.5], [0.7], [0.9]])
    changes = 50.0 * np.sin(2.0 * units) * AXES[0] + 20.0 * units**2 * AXES[1]
    emulator = Emulator(trial_of(units, changes, 1.0e-4), neutral=np.array([0.0]))
    mean, variance = emulator(np.array([[0.0], [0.5], [0.6], [3.0]]))
    change = mean @ emulator.directions
    assert np.abs(change[0]).max() < 0.1  # nothing where it is neutral
    assert change[1] == pytest.approx(changes[2], abs=0.1)
    wanted = 50.0 * np.sin(1.2) * AXES[0] + 20.0 * 0.36 * AXES[1]
    assert change[2] == pytest.approx(wanted, abs=0.3)
    assert variance[1].max() < 0.1 < 100.0 < variance[3].max()


def test_scatter_along_what_a_run_changes_is_that_of_its_seeds():
    random = np.random.default_rng(5)
    trial = Trial(Line(), np.zeros((0, 1)), np.zeros((0, VALUES)), np.zeros(0), [])
    for unit in np.linspace(0.1, 1.0, 10):
        seeds = random.standard_normal((8, VALUES))
        seeds[:, :] += 2.0 * random.standard_normal((8, 1)) * AXES[0] + 40.0 * unit * AXES[0]
        trial.add(np.array([unit]), seeds)
    emulator = Emulator(trial, np.array([0.0]), answer=20.0 * AXES[0])
    along = int(np.argmax(np.abs(emulator.directions @ AXES[0])))
    assert 1.0 + emulator.excess[along] == pytest.approx(5.0, rel=0.3)
    far = trial.scatter(AXES[1:2], np.ones(10))
    assert far == pytest.approx(1.0, rel=0.3)


def test_length_is_that_of_each_parameter():
    """A resonance turns within a twentieth of a range along which nothing else happens."""
    units = qmc.Sobol(2, seed=1).random(32)
    changes = 30.0 * np.sin(units[:, :1] / 0.08) * AXES[0]
    emulator = Emulator(trial_of(units, changes, 1.0e-4), answer=changes[3])
    assert emulator.length[0] < 0.2 < 0.5 < emulator.length[1]


def test_two_effects_add_until_a_run_corrects_the_sum():
    units = np.linspace(0.0, 1.0, 6)[:, None]
    first, second = (
        Emulator(trial_of(units, 30.0 * units * axis, 1.0e-4), np.array([0.0])) for axis in AXES[:2]
    )
    both = np.array([[0.5, 0.4]])
    sum_ = (15.0 * AXES[0] + 12.0 * AXES[1])[None]
    for more in (0.0, 8.0):
        emulator = PairEmulator(trial_of(both, sum_ + more * AXES[2], 1.0e-4), first, second)
        change = emulator(both)[0] @ emulator.directions
        assert change == pytest.approx(sum_ + more * AXES[2], abs=0.5)


def test_peak_narrower_than_the_samples_is_found():
    measured = 900.0 * AXES[0]
    found = fit(Known(2000.0), 1, null_with(measured), start=np.array([0.44]))
    assert found.unit[0] == pytest.approx(0.45, abs=0.01)
    assert evidence.SAMPLES < 2000.0  # the peak is a two thousandth of the range wide
