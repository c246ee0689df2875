"""Results of costly functions kept by the content of what they were made from: variants of a model
differ in little of it.
"""

import hashlib

MOST = 8  # results of each function: a variant or two beside the bare model


class Kept:
    """The last MOST results, by key."""

    def __init__(self):
        self.results = {}

    def get(self, key, make):
        """Return the result of make(), or the one kept under the key."""
        if key not in self.results:
            while len(self.results) >= MOST:
                self.results.pop(next(iter(self.results)))
            self.results[key] = make()
        return self.results[key]


def content_key(*parts):
    """Return a digest of strings and arrays."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(
            part.encode() if isinstance(part, str) else str(part.shape).encode() + part.tobytes()
        )
    return digest.digest()
