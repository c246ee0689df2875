"""The methods of identification in words, the same in figures and on pages."""

METHOD_NAMES = {
    "peak_half": "peak width at 1/2",
    "peak_quarter": "peak width at 1/4",
    "peak_25th": "peak width at 1/25",
    "lscf": "LSCF pole",
    "ods": "deflection shape",
    "broadband": "broadband PSD",
    "statistical_linearisation": "statistical linearisation",
    "secant": "mean secant stiffness",
}


def method_name(method: str) -> str:
    """Return a method in words; one that is not known here by its own name, without underscores."""
    return METHOD_NAMES.get(method, method.replace("_", " "))
