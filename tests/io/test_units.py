"""Units: printed conversion factors, what g means, and refusals that say what to write."""

import pytest

from vibroimpact.io.units import UnitError, si_factor, si_unit


@pytest.mark.parametrize(
    "text, kind, factor",
    [
        ("m s-2", "acceleration", 1.0),
        ("m/s²", "acceleration", 1.0),
        ("m·s⁻²", "acceleration", 1.0),
        ("m s^-2", "acceleration", 1.0),
        ("mm.s-2", "acceleration", 1e-3),
        ("g", "acceleration", 9.80665),
        ("mg", "acceleration", 9.80665e-3),
        ("gn", "acceleration", 9.80665),
        ("ft/s²", "acceleration", 0.3048),
        ("in/s^2", "acceleration", 0.0254),
        ("cm/s/s", "acceleration", 0.01),
        ("mm/s", "velocity", 1e-3),
        ("km h-1", "velocity", 1 / 3.6),
        ("µm", "displacement", 1e-6),
        ("μm", "displacement", 1e-6),
        ("um", "displacement", 1e-6),
        ("mil", "displacement", 2.54e-5),
        ("0.001 m", "displacement", 1e-3),
        ("lbf", "force", 4.4482216152605),
        ("kgf", "contact_force", 9.80665),
        ("kN", "excitation", 1e3),
        ("mV", "excitation", 1e-3),
        ("mV", "voltage", 1e-3),
        ("bar", "generic", 1e5),
        ("Newton", "force", 1.0),
        ("NEWTONS", "excitation", 1.0),
        ("KN", "force", 1e3),
        ("mN", "force", 1e-3),
        ("ips", "velocity", 0.0254),
        ("IPS", "velocity", 0.0254),
        ("Sec", "time", 1.0),
        ("Inches/Sec^2", "acceleration", 0.0254),
        ("Volts", "voltage", 1.0),
        ("1", "generic", 1.0),
    ],
)
def test_a_unit_has_its_printed_factor(text, kind, factor):
    assert si_factor(text, kind) == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize(
    "text, kind, told",
    [
        ("", "acceleration", "has no unit"),
        ("bananas", "velocity", "not known"),
        ("m", "acceleration", "no acceleration"),
        ("g", "displacement", "no displacement"),
        ("lb", "force", "write lbf"),
        ("m s-2", "excitation", "no excitation"),
        ("Pa", "voltage", "no voltage"),
    ],
)
def test_unknown_unit_is_refused(text, kind, told):
    with pytest.raises(UnitError, match=told):
        si_factor(text, kind)


@pytest.mark.parametrize(
    "text, kind, si",
    [
        ("g", "acceleration", "m s-2"),
        ("lbf", "excitation", "N"),
        ("mV", "excitation", "V"),
        ("mm", "generic", "m"),
        ("Newton", "generic", "N"),
        ("Kelvin", "generic", "K"),
        ("1", "generic", "1"),
    ],
)
def test_base_unit_of_a_unit(text, kind, si):
    assert si_unit(text, kind) == si
