"""A small memo of costly results, by the content of their arguments.

Variants of a model differ in little: most share the finite-element matrices and the Ritz basis.
"""

import hashlib
from collections.abc import Callable, Hashable
from threading import RLock
from typing import Any

import numpy as np

MAX_ENTRIES = 8  # the unchanged model and a few variants


class Memo:
    """The last MAX_ENTRIES results by key; the one unused for the longest is dropped first."""

    def __init__(self) -> None:
        self.results: dict[Hashable, Any] = {}
        self.lock = RLock()  # threads that ask for the same result make it once

    def get(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """Return the result stored under a key, or that of make(), which is then stored."""
        with self.lock:
            if key not in self.results:
                while len(self.results) >= MAX_ENTRIES:
                    self.results.pop(next(iter(self.results)))
                self.results[key] = make()
            self.results[key] = self.results.pop(key)  # the last one that was asked for
            return self.results[key]


def content_key(*parts: str | np.ndarray) -> bytes:
    """Return a digest of strings and arrays: of their values, shapes and order."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(
            part.encode() if isinstance(part, str) else str(part.shape).encode() + part.tobytes()
        )
    return digest.digest()
