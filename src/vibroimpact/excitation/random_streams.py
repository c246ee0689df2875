"""Random generators with a seed of their own for every use, keyed by name.

A stream depends on its key only: another stream, or another number of draws elsewhere, changes
nothing in it. Streams of different keys are independent.
"""

import hashlib

import numpy as np


def random_generator(entropy: int, *key: int | str) -> np.random.Generator:
    """Return the generator of a key, such as (seed index, "force") or (stage, effect, point).

    entropy: the seed of the study; key: numbers from 0 and names, in order. Raises ValueError for
    a negative number.
    """
    spawn_key = [word for part in key for word in _words(part)]
    sequence = np.random.SeedSequence(entropy, spawn_key=spawn_key)
    return np.random.Generator(np.random.PCG64(sequence))


def _words(part: int | str) -> list[int]:
    """Return the 32-bit words of a part of a key: four of its SHA-256 if it is a name."""
    if isinstance(part, str):
        digest = hashlib.sha256(part.encode()).digest()[:16]
        return [int(word) for word in np.frombuffer(digest, dtype="<u4")]
    if part < 0:
        raise ValueError(f"{part} is negative: number the streams of a key from 0")
    return [part]
