"""Random streams: the same for a key wherever they are made, independent of all others."""

import numpy as np
import pytest

from vibroimpact.excitation.random_streams import random_generator


def test_a_stream_is_the_same_wherever_it_is_made():
    # The words of the spawn key come from SHA-256 of the name. They must never change: old results
    # would lose their seed.
    sequence = np.random.SeedSequence(
        2012, spawn_key=(0, 1963806770, 1426574848, 1861853377, 3272633336)
    )
    words = np.random.Generator(np.random.PCG64(sequence)).integers(0, 2**32, 3)
    assert random_generator(2012, 0, "force").integers(0, 2**32, 3).tolist() == words.tolist()


def test_streams_of_other_names_and_seeds_are_independent():
    keys = [
        (seed, index, name)
        for seed in (1, 2)
        for index in (0, 1)
        for name in ("force", "imperfection")
    ]
    draws = np.array([random_generator(*key).standard_normal(20000) for key in keys])
    correlation = np.corrcoef(draws)
    assert np.abs(correlation - np.eye(len(keys))).max() < 5 / np.sqrt(20000)


def test_every_part_of_a_key_counts():
    keys = [(), (0,), ("gap",), ("gap", 0), ("gap", 1), (0, "gap"), ("screening", "gap", 0)]
    assert len({int(random_generator(5, *key).integers(2**63)) for key in keys}) == len(keys)
    with pytest.raises(ValueError, match="-1 is negative"):
        random_generator(5, -1)
