"""The curves behind the estimates of one case, as a dataset for the figures."""

from typing import Any

import numpy as np
import xarray as xr

from .broadband import BroadbandFit
from .identify_supports import SupportsCase, SupportsResult
from .ods import DeflectionShape, ShapeMatch
from .operational_pole import OperationalPole
from .peak import LEVELS, PeakFit


def case_curves(
    case: Any,
    peaks: dict[str, PeakFit | None],
    pole: OperationalPole | None,
    shape: tuple[DeflectionShape, ShapeMatch] | None,
    broad: BroadbandFit | None,
) -> xr.Dataset:
    """Return the curves of one case: fits, stabilisation chart, shape, MAC and correlation maps.

    case: CaseSpectra.
    peaks: {method: PeakFit or None}.
    pole, shape, broad: as CaseSpectra returns them.
    """
    tube = case.tube
    data = _peak_variables(peaks, case.frequency)
    if pole is not None:
        data |= _chart_variables(pole)
    if shape is not None:
        data |= _shape_variables(*shape)
    data |= {
        "map_k": _variable("map_k", tube.broadband_map.k, "N m-1", "support stiffness"),
        "map_c": _variable(
            ("map_k", "map_damping"), tube.broadband_map.c, "N s m-1", "support damping"
        ),
    }
    if broad is not None:
        data |= {
            "correlation": _variable(
                ("map_k", "map_damping"), broad.correlation_map, "1", "correlation coefficient"
            ),
            "best_correlation": _variable(
                (), broad.correlation, "1", "correlation coefficient at the maximum"
            ),
            "broadband_curve": _variable(
                "broadband_frequency", broad.curve, "m2 Hz-1", "best PSD of the family"
            ),
        }
    return xr.Dataset(data, _coordinates(list(peaks), case.frequency, tube.broadband))


def supports_curves(case: SupportsCase, result: SupportsResult) -> xr.Dataset:
    """Return the curves of one case with several unknown supports, as case_curves does.

    There is no map over one k and c; the covariance of ln k over the directions takes its place.
    """
    tube = case.tube
    data = _peak_variables(result.peaks, tube.frequency)
    if result.pole is not None:
        data |= _chart_variables(result.pole)
    if result.shape is not None:
        data |= _deflection_variables(result.shape)
    if result.shapes is not None:
        data["best_mac"] = _variable((), result.shapes.mac, "1", "mean MAC of the shapes")
    if result.spectra is not None:
        count = len(tube.directions)
        data |= {
            "best_correlation": _variable(
                (), result.spectra.correlation, "1", "smallest correlation coefficient of a sensor"
            ),
            "broadband_curve": _variable(
                "broadband_frequency",
                result.spectra.curve[tube.sensors.broadband],
                "m2 Hz-1",
                "best PSD of the linear structure",
            ),
            "log_stiffness_covariance": _variable(
                ("support_direction", "other_support_direction"),
                result.spectra.covariance[:count, :count],
                "1",
                "covariance of the logarithms of the stiffnesses, broadband comparison",
            ),
        }
    coords = _coordinates(list(result.peaks), tube.frequency, tube.broadband)
    names = [direction.name for direction in tube.directions]
    about = {"long_name": "group of supports and direction"}
    return xr.Dataset(data, coords | {"support_direction": ("support_direction", names, about)})


def _coordinates(levels: list[str], frequency: np.ndarray, broadband: slice) -> dict[str, tuple]:
    """Return the coordinates of the curves: levels of the peak, and frequencies in Hz."""
    hertz = {"units": "Hz", "long_name": "frequency"}
    return {
        "level": ("level", levels, {"long_name": "method by the width of the peak"}),
        "low_frequency": ("low_frequency", frequency, hertz),
        "broadband_frequency": ("broadband_frequency", frequency[broadband], hertz),
    }


def _peak_variables(peaks: dict[str, PeakFit | None], frequency: np.ndarray) -> dict:
    fitted = np.full((len(peaks), frequency.size), np.nan)
    for row, fit in zip(fitted, peaks.values(), strict=True):
        if fit is not None:
            row[fit.bins] = fit.curve
    return {
        "peak_curve": _variable(
            ("level", "low_frequency"), fitted, "m2 Hz-1", "fitted resonance curve"
        ),
        "peak_level": _variable("level", list(LEVELS.values()), "1", "peak over level"),
    }


def _chart_variables(pole: OperationalPole) -> dict[str, tuple]:
    """Return the stabilisation chart as variables over `pole`."""
    chart = pole.chart
    frequency = np.abs(chart.pole) / (2.0 * np.pi)
    stable = {
        "frequency": chart.stable_frequency,
        "damping": chart.stable_damping,
        "participation": chart.stable_participation,
    }
    variables = {
        f"chart_stable_{name}": _variable("pole", flag.astype(np.int8), "1", f"stable in {name}")
        for name, flag in stable.items()
    }
    return variables | {
        "chart_order": _variable("pole", chart.order.astype(np.int16), "1", "polynomial order"),
        "chart_frequency": _variable("pole", frequency, "Hz", "frequency of the pole"),
        "chart_damping_ratio": _variable(
            "pole", -chart.pole.real / np.abs(chart.pole), "1", "damping ratio of the pole"
        ),
        "chart_orders_taken": _variable(
            "taken", np.array([pole.order], dtype=np.int16), "1", "order whose pole was taken"
        ),
    }


def _shape_variables(measured: DeflectionShape, match: ShapeMatch) -> dict[str, tuple]:
    """Return the deflection shape and its MAC over k as variables."""
    return _deflection_variables(measured) | {
        "mac_k": _variable("mac_k", match.k_grid, "N m-1", "support stiffness"),
        "mac": _variable("mac_k", match.mac_grid, "1", "MAC with the linear tube's shape"),
        "best_mac": _variable((), match.mac, "1", "largest MAC"),
    }


def _deflection_variables(measured: DeflectionShape) -> dict[str, tuple]:
    """Return the deflection shape as variables."""
    turned = measured.shape * np.exp(-0.5j * np.angle(np.sum(measured.shape**2)))
    turned = turned if turned.real[np.argmax(np.abs(turned))] > 0.0 else -turned
    return {
        "ods_re": _variable(
            "line_point", turned.real, "1", "operational deflection shape, part in phase"
        ),
        "ods_im": _variable(
            "line_point", turned.imag, "1", "operational deflection shape, part in quadrature"
        ),
        "singular_value": _variable(
            "value", measured.singular_values, "1", "singular value over the first"
        ),
        "ods_band": _variable("edge", np.array(measured.band_Hz), "Hz", "band of the shape"),
    }


def _variable(dims: Any, values: Any, units: str, long_name: str) -> tuple:
    """Return a variable of a dataset with its unit and name."""
    return dims, values, {"units": units, "long_name": long_name}
