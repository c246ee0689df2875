"""Numbers as texts of a page."""


def digits(value: float | None) -> str:
    """Return a number with 3 digits, whole up to 100000, - if there is none."""
    if value is None or value != value:
        return "-"
    return f"{value:.0f}" if 1e3 <= abs(value) < 1e5 else f"{value:.3g}"


def percent(fraction: float | None) -> str:
    """Return a share in whole per cent, - if there is none."""
    return "-" if fraction is None or fraction != fraction else f"{100 * fraction:.0f} %"


def span(low: float, high: float) -> str:
    """Return an interval as text."""
    return f"{digits(low)} to {digits(high)}"


def range_text(low: float, high: float) -> str:
    """Return the range of some values as text, one number if it has no width."""
    return digits(low) if digits(low) == digits(high) else span(low, high)
