"""One claim of the paper and what this study measured."""

from dataclasses import asdict, dataclass

HOLDS, CONDITIONS, FAILS = "holds", "holds with conditions", "does not hold here"
AGREE = 0.25  # of the median: what "agree" means throughout


@dataclass(frozen=True)
class Claim:
    """A claim of the paper, how it was measured, and whether it holds.

    claim, section: of the paper.
    measure: what was computed.
    value: the numbers, with units.
    threshold: what the numbers are compared with.
    verdict: HOLDS, CONDITIONS or FAILS.
    why: a sentence with the condition or the reason, with numbers.
    """

    claim: str
    section: str
    measure: str
    value: str
    threshold: str
    verdict: str
    why: str

    def row(self) -> dict:
        """Return the claim as a row of claims.csv."""
        return asdict(self)


def graded(full: bool, partly: bool) -> str:
    """Return the verdict: HOLDS when `full`, CONDITIONS when only `partly`, else FAILS."""
    return HOLDS if full else CONDITIONS if partly else FAILS


def text(values, digits=3) -> str:
    """Return numbers as they read in a sentence: 1.23, 0.0045, 6.7e+05."""
    return ", ".join(f"{value:.{digits}g}" for value in values)
