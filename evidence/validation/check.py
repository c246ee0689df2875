"""A comparison of one computed quantity with its reference."""

from dataclasses import dataclass

COLUMNS = ("case", "quantity", "unit", "reference", "source", "ours", "error", "tolerance", "pass")


@dataclass(frozen=True)
class Check:
    """A quantity computed by the project and its reference value.

    case: name of the reference case, such as "R3".
    unit: of reference and ours, "1" for a pure number.
    source: of the reference.
    tolerance: the largest error that passes.
    scale: divides the difference to give the error, in the same unit; the reference where it is not
    given. A scale of 1.0 makes the error absolute.
    """

    case: str
    quantity: str
    unit: str
    reference: float
    source: str
    ours: float
    tolerance: float
    scale: float | None = None

    @property
    def error(self) -> float:
        """Return |ours - reference| / scale."""
        return abs(self.ours - self.reference) / abs(
            self.reference if self.scale is None else self.scale
        )

    @property
    def passed(self) -> bool:
        """Return True when the error is within the tolerance; a NaN never is."""
        return bool(self.error <= self.tolerance)

    def row(self) -> dict:
        """Return the check as a row of validation.csv."""
        return {
            "case": self.case,
            "quantity": self.quantity,
            "unit": self.unit,
            "reference": self.reference,
            "source": self.source,
            "ours": self.ours,
            "error": self.error,
            "tolerance": self.tolerance,
            "pass": self.passed,
        }
