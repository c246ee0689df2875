"""What of a response is no smooth function of frequency times the force."""

import numpy as np

from vibroimpact.linear_stage.other_source import BLOCK, FREE, incoherent

LINES = 40 * BLOCK


def noise(seed, *shape):
    """Complex normal lines."""
    real, imaginary = np.random.default_rng(seed).standard_normal((2, *shape))
    return real + 1j * imaginary


def test_smooth_response_and_ends_of_a_record_are_coherent():
    force, ramp = noise(1, LINES), np.linspace(0.0, 1.0, LINES)
    lines = (2.0 + 3.0j * ramp) * force + (5.0 - 1.0j) * ramp
    np.testing.assert_allclose(incoherent(force, lines[None]), 0.0, atol=1.0e-12)


def test_other_source_keeps_its_share_of_free_values():
    force, other = noise(1, LINES), noise(2, 1, LINES)
    left = np.sum(np.abs(incoherent(force, other)) ** 2) / np.sum(np.abs(other) ** 2)
    assert abs(left - (1.0 - FREE / BLOCK)) < 0.05
