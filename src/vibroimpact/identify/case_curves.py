"""The curves behind the estimates of one case, as a dataset for the figures."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from .identify_supports import SupportsCase
from .observed_case import ObservedCase
from .ods import DeflectionShape
from .operational_pole import OperationalPole
from .peak import LEVELS

# name: (dimensions, units, long name)
CURVES = {
    "peak_curve": ("level low_frequency", "m2 Hz-1", "fitted resonance curve"),
    "peak_level": ("level", "1", "peak over level"),
    "chart_stable_frequency": ("pole", "1", "stable in frequency"),
    "chart_stable_damping": ("pole", "1", "stable in damping"),
    "chart_stable_participation": ("pole", "1", "stable in participation"),
    "chart_order": ("pole", "1", "polynomial order"),
    "chart_frequency": ("pole", "Hz", "frequency of the pole"),
    "chart_damping_ratio": ("pole", "1", "damping ratio of the pole"),
    "chart_orders_taken": ("taken", "1", "order whose pole was taken"),
    "ods_re": ("line_point", "1", "operational deflection shape, part in phase"),
    "ods_im": ("line_point", "1", "operational deflection shape, part in quadrature"),
    "singular_value": ("value", "1", "singular value over the first"),
    "ods_band": ("edge", "Hz", "band of the shape"),
    "mac_k": ("mac_k", "N m-1", "support stiffness"),
    "mac": ("mac_k", "1", "MAC with the linear tube's shape"),
    "best_mac": ("", "1", "largest MAC"),
    "map_k": ("map_k", "N m-1", "support stiffness"),
    "map_c": ("map_k map_damping", "N s m-1", "support damping"),
    "correlation": ("map_k map_damping", "1", "correlation coefficient"),
    "best_correlation": ("", "1", "correlation coefficient at the maximum"),
    "broadband_curve": ("broadband_frequency", "m2 Hz-1", "best PSD of the family"),
}
# Those of several unknown supports.
SUPPORTS_CURVES = CURVES | {
    "best_mac": ("", "1", "mean MAC of the shapes"),
    "best_correlation": ("", "1", "smallest correlation coefficient of a sensor"),
    "broadband_curve": ("broadband_frequency", "m2 Hz-1", "best PSD of the linear structure"),
    "log_stiffness_covariance": (
        "support_direction other_support_direction",
        "1",
        "covariance of the logarithms of the stiffnesses, broadband comparison",
    ),
}


def case_curves(case: ObservedCase, more: dict[str, Any], declared: Mapping = CURVES) -> xr.Dataset:
    """Return the curves of one case: fits, stabilisation chart and shape, and those of `more`.

    more: {name: values}. declared: of all names, in the form of CURVES.
    """
    layout = case.layout
    frequency, hertz = layout.frequency, {"units": "Hz", "long_name": "frequency"}
    fitted = np.full((len(case.peaks), frequency.size), np.nan)
    for row, fit in zip(fitted, case.peaks.values(), strict=True):
        if fit is not None:
            row[fit.bins] = fit.curve
    data = {"peak_curve": fitted, "peak_level": list(LEVELS.values())}
    data |= _chart(case.pole) | _deflection(case.shape) | more
    variables = {}
    for name, values in data.items():
        dims, units, long_name = declared[name]
        variables[name] = (dims.split(), values, {"units": units, "long_name": long_name})
    return xr.Dataset(
        variables,
        {
            "level": ("level", list(case.peaks), {"long_name": "method by the width of the peak"}),
            "low_frequency": ("low_frequency", frequency, hertz),
            "broadband_frequency": ("broadband_frequency", frequency[layout.broadband_bins], hertz),
        },
    )


def supports_curves(case: SupportsCase) -> xr.Dataset:
    """Return the curves of one case with several unknown supports, as case_curves does.

    There is no map over one k and c; the covariance of ln k over the directions takes its place.
    """
    directions = case.tube.directions
    more: dict[str, Any] = {}
    if case.by_shapes is not None:
        more["best_mac"] = case.by_shapes.mac
    if case.by_spectra is not None:
        stiffnesses, spectra = slice(len(directions)), case.by_spectra
        more |= {
            "best_correlation": spectra.correlation,
            "broadband_curve": spectra.curve[case.layout.broadband],
            "log_stiffness_covariance": spectra.found.covariance[stiffnesses, stiffnesses],
        }
    names = [direction.name for direction in directions]
    about = {"long_name": "group of supports and direction"}
    return case_curves(case, more, SUPPORTS_CURVES).assign_coords(
        support_direction=("support_direction", names, about)
    )


def _chart(pole: OperationalPole | None) -> dict[str, Any]:
    """Return the stabilisation chart over `pole`; nothing without a pole."""
    if pole is None:
        return {}
    chart, size = pole.chart, np.abs(pole.chart.pole)
    return {
        "chart_stable_frequency": chart.stable_frequency.astype(np.int8),
        "chart_stable_damping": chart.stable_damping.astype(np.int8),
        "chart_stable_participation": chart.stable_participation.astype(np.int8),
        "chart_order": chart.order.astype(np.int16),
        "chart_frequency": size / (2.0 * np.pi),
        "chart_damping_ratio": -chart.pole.real / size,
        "chart_orders_taken": np.array([pole.order], dtype=np.int16),
    }


def _deflection(measured: DeflectionShape | None) -> dict[str, Any]:
    """Return the deflection shape in the phase in which most of it is real and positive."""
    if measured is None:
        return {}
    turned = measured.shape * np.exp(-0.5j * np.angle(np.sum(measured.shape**2)))
    turned = turned if turned.real[np.argmax(np.abs(turned))] > 0.0 else -turned
    return {
        "ods_re": turned.real,
        "ods_im": turned.imag,
        "singular_value": measured.singular_values,
        "ods_band": np.array(measured.band_Hz),
    }
