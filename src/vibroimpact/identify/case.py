"""All methods on one case: its spectra and its model in, estimates and the curves behind them
out.
"""

from functools import lru_cache

import numpy as np
import xarray as xr

from vibroimpact.spectra.welch import complex_values

from .broadband import identify_broadband
from .estimate import FREQUENCY_ERROR, Estimate, graded, unresolved, weakened
from .linearisation import secant_stiffness, statistical_linearisation
from .ods import deflection_shape, match_shape
from .operational_pole import PoleSearch, operational_pole
from .peak import LEVELS, find_peak, fit_peak
from .reference_tube import Bins, ReferenceTube, Sensors
from .segments import effective_duration, left_out_changes, segment_covariance
from .update import support_from_pole

RECORD_READ = (
    "force_displacement",
    "displacement_square",
)  # of the files, all that identify_case asks for
SPECTRA_READ = (
    "sensor_spectra_re",
    "sensor_spectra_im",
    "line_spectra_re",
    "line_spectra_im",
    "effective_averages",
)
DAMPING_RATIO_LIMIT = (
    0.5  # c is not resolved when its error is more than this part of the pole's damping ratio
)
ONE_SHAPE = 0.9  # MAC below which the motion around the peak is no longer one shape of the family
FEWEST_SHAPE_BINS = 3
# correlation below which the best spectrum of the family does not look like the measured one
ALIKE = 0.8


def identify_case(config, model, record, spectra):
    """Return (list of Estimate, Dataset of curves) of one case.

    config: with excitation, spectra and identification; model: ModalModel; record: statistics of
    the case (force_displacement, displacement_square, attributes load_rms_N, gap_m); spectra:
    Dataset of spectra.case_spectra. No estimate fails the case: what a method can not see comes
    back unresolved, with a note.
    """
    tube = reference_tube(config, model, spectra)
    case = CaseSpectra(spectra, tube)
    peaks = {
        method: case.fit_main_peak(level, config.identification.peak_search_Hz)
        for method, level in LEVELS.items()
    }
    pole = case.operational_pole(config.identification)
    shape = case.shape(peaks["peak_25th"])
    broad = case.broadband()
    estimates = [_from_pole(method, fit, tube) for method, fit in peaks.items()]
    estimates += [
        _from_operational_pole(pole, tube),
        _from_shape(shape, tube, case.averages),
        _from_broadband(broad, tube),
    ]
    estimates += comparison_estimates(config, model, record)
    return estimates, curves(case, peaks, pole, shape, broad)


def reference_tube(config, model, spectra):
    """Return the ReferenceTube of a model and the bins of spectra; built once per process for the
    same model and settings.
    """
    identification = config.identification
    axis = "." + str(spectra["driven_sensor"].values[0]).rsplit(".", 1)[1]
    names = tuple(str(name) for name in spectra["driven_sensor"].values)
    sensors = Sensors(
        names,
        names.index(identification.response_point + axis),
        names.index(identification.broadband.point + axis),
        tuple(names.index(point + axis) for point in identification.lscf.references),
    )
    low, line = spectra["low_frequency"].values, spectra["line_frequency"].values
    spacing = 1.0 / float(spectra.attrs["segment_s"])
    bins = Bins(
        spacing,
        low.size - 1,
        int(round(line[0] / spacing)),
        int(round(line[-1] / spacing)),
        str(spectra.attrs["window"]),
    )
    excitation = config.excitation
    force_band = (
        tuple(excitation.band_Hz) if excitation.kind == "band_limited" else (0.0, float("inf"))
    )
    return _reference_tube(
        model,
        bins,
        sensors,
        force_band,
        tuple(identification.broadband.band_Hz),
        tuple(identification.stiffness_range_N_per_m),
    )


@lru_cache(maxsize=2)
def _reference_tube(model, bins, sensors, force_band, broadband_band, stiffness_range):
    return ReferenceTube(model, bins, sensors, force_band, broadband_band, stiffness_range)


class CaseSpectra:
    """The spectra of one case as the methods read them."""

    def __init__(self, spectra, tube):
        self.tube = tube
        self.averages = float(spectra["effective_averages"])
        self.frequency = tube.frequency
        self.outputs = complex_values(spectra, "sensor_spectra")
        self.line = complex_values(spectra, "line_spectra")
        self.line_frequency = spectra["line_frequency"].values
        response = self.outputs[tube.sensors.response]
        self.segments = response.real**2 + response.imag**2
        self.psd = self.segments.mean(axis=0)
        self.peak = None

    def fit_main_peak(self, level, search_Hz):
        """Return the PeakFit at a level of the main peak, or None."""
        self.peak = self.peak or find_peak(self.frequency, self.psd, search_Hz)
        return fit_peak(
            self.frequency,
            self.psd,
            self.tube.kernel,
            level,
            self.peak,
            self.tube.other_modes,
            self.averages,
            self.segments,
        )

    def operational_pole(self, identification):
        """Return the OperationalPole of the main peak, or None."""
        search = PoleSearch(
            self.frequency,
            tuple(identification.lscf.band_Hz),
            self.tube.bins.window,
            identification.lscf.max_order,
        )
        return operational_pole(
            self.outputs,
            self.tube.sensors.references,
            search,
            self.peak,
            self.averages,
            effective_duration(self.averages, self.tube.kernel),
            self.tube.cross_spectra,
        )

    def shape(self, fit):
        """Return (DeflectionShape, ShapeMatch) over the band above 1/25 of the fitted peak, or None
        without a peak.
        """
        if fit is None:
            return None
        edges = np.clip(fit.edges_Hz, self.line_frequency[0], self.line_frequency[-1])
        if edges[1] - edges[0] < FEWEST_SHAPE_BINS * self.tube.bins.spacing_Hz:
            return None
        measured = deflection_shape(self.line, self.line_frequency, tuple(edges))
        return measured, match_shape(
            measured,
            self.tube.at_line,
            self.tube.mode_shapes,
            self.tube.shape_members(fit.damping_ratio, np.sqrt(fit.covariance[1, 1])),
        )

    def broadband(self):
        """Return the BroadbandFit, or None."""
        values = self.outputs[self.tube.sensors.broadband][:, self.tube.broadband]
        segments = values.real**2 + values.imag**2
        return identify_broadband(
            segments.mean(axis=0),
            self.tube.at_broadband,
            self.tube.kernel,
            self.tube.broadband_map,
            self.tube.least_damping,
            self.averages,
            segments,
        )


def _from_pole(method, fit, tube):
    """Return the Estimate of a pole (PeakFit or OperationalPole)."""
    if fit is None:
        return unresolved(method, "no resonance could be fitted to the main peak")
    support = support_from_pole(tube.modes, fit.frequency, fit.damping_ratio)
    errors = np.sqrt(np.diag(support.jacobian @ fit.covariance @ support.jacobian.T))
    estimate = Estimate(
        method,
        support.k,
        float(errors[0]),
        support.c,
        float(errors[1]),
        fit.frequency,
        fit.damping_ratio,
    )
    model_error = abs(support.jacobian[0, 0]) * FREQUENCY_ERROR * fit.frequency
    limit = DAMPING_RATIO_LIMIT * fit.damping_ratio * abs(support.jacobian[1, 1])
    return graded(estimate, model_error, tube.pole_error_free, tube.stiffness_range, limit)


def _from_operational_pole(pole, tube):
    """Return the Estimate of the LSCF pole."""
    estimate = _from_pole("lscf", pole, tube)
    if pole is not None and not pole.stable:
        estimate = weakened(
            estimate, f"no single pole is stable from order to order; order {pole.order} taken"
        )
    return estimate


def _from_shape(shape, tube, averages):
    """Return the Estimate of a matched shape: k alone, a shape carries no damping."""
    if shape is None:
        return unresolved("ods", "no peak sets a band inside that of the shape line's spectra")
    measured, match = shape
    own = segment_covariance(left_out_changes(match.segment_changes[:, None]), averages)[0, 0]
    error = float(np.sqrt(own + match.damping_change**2))
    estimate = Estimate("ods", match.k, match.k * error)
    estimate = graded(
        estimate, match.k * match.model_error, tube.shape_error_free, tube.stiffness_range
    )
    return (
        weakened(estimate, f"best MAC only {match.mac:.2f}") if match.mac < ONE_SHAPE else estimate
    )


def _from_broadband(fit, tube):
    """Return the Estimate of the broadband correlation; the error of the model is that of its first
    frequency.
    """
    if fit is None:
        return unresolved("broadband", "the correlation has no maximum in the family")
    frequency = tube.first_frequency(fit.k)
    ratio = tube.free_ratio(fit.k) + fit.c * tube.ratio_slope(fit.k)
    model_error = FREQUENCY_ERROR * fit.k / tube.frequency_slope(fit.k)
    errors = np.sqrt(np.diag(fit.covariance))
    estimate = Estimate(
        "broadband", fit.k, float(errors[0]), fit.c, float(errors[1]), frequency, ratio
    )
    limit = DAMPING_RATIO_LIMIT * abs(ratio) / tube.ratio_slope(fit.k)
    estimate = graded(estimate, model_error, tube.pole_error_free, tube.stiffness_range, limit)
    return (
        weakened(estimate, f"correlation only {fit.correlation:.2f}")
        if fit.correlation < ALIKE
        else estimate
    )


def comparison_estimates(config, model, record):
    """Return the Estimates of statistical linearisation and of the secant stiffness: neither comes
    from a response's spectrum.
    """
    if config.excitation.kind == "band_limited":
        case = _linearisation(
            model,
            float(record.attrs["load_rms_N"]),
            float(record.attrs["gap_m"]),
            tuple(config.excitation.band_Hz),
        )
        predicted = Estimate(
            "statistical_linearisation",
            case.k,
            0.0,
            frequency=case.frequency,
            damping_ratio=case.damping_ratio,
        )
        predicted = (
            predicted if case.settled else weakened(predicted, "the iteration did not settle")
        )
    else:
        predicted = unresolved("statistical_linearisation", "needs a force of flat PSD in a band")
    k, error = secant_stiffness(
        record["force_displacement"].values,
        record["displacement_square"].values,
        model.contact_weight,
        model.support_of_point,
    )
    return [
        predicted,
        Estimate("secant", k, error, note="standard error from the scatter over supports"),
    ]


@lru_cache(maxsize=32)
def _linearisation(model, load_rms_N, gap_m, band_Hz):
    return statistical_linearisation(model, load_rms_N, gap_m, band_Hz)


def curves(case, peaks, pole, shape, broad):
    """Return the Dataset of what the figures show of one case: fitted curves, stabilisation chart,
    shape, MAC and correlation maps.
    """
    tube = case.tube
    fitted = np.full((len(peaks), case.frequency.size), np.nan)
    for row, fit in zip(fitted, peaks.values(), strict=True):
        if fit is not None:
            row[fit.bins] = fit.curve
    data = {
        "peak_curve": (
            ("level", "low_frequency"),
            fitted,
            {"units": "m2 Hz-1", "long_name": "fitted resonance curve"},
        ),
        "peak_level": (
            "level",
            list(LEVELS.values()),
            {"units": "1", "long_name": "peak over level"},
        ),
    }
    if pole is not None:
        data |= _chart_variables(pole)
    if shape is not None:
        data |= _shape_variables(*shape)
    data |= {
        "map_k": (
            "map_k",
            tube.broadband_map.k,
            {"units": "N m-1", "long_name": "support stiffness"},
        ),
        "map_c": (
            ("map_k", "map_damping"),
            tube.broadband_map.c,
            {"units": "N s m-1", "long_name": "support damping"},
        ),
    }
    if broad is not None:
        data |= {
            "correlation": (
                ("map_k", "map_damping"),
                broad.correlation_map,
                {"units": "1", "long_name": "correlation coefficient"},
            ),
            "best_correlation": (
                (),
                broad.correlation,
                {"units": "1", "long_name": "correlation coefficient at the maximum"},
            ),
            "broadband_curve": (
                "broadband_frequency",
                broad.curve,
                {"units": "m2 Hz-1", "long_name": "best PSD of the family"},
            ),
        }
    coords = {
        "level": list(peaks),
        "low_frequency": ("low_frequency", case.frequency, {"units": "Hz"}),
        "broadband_frequency": (
            "broadband_frequency",
            case.frequency[tube.broadband],
            {"units": "Hz"},
        ),
    }
    return xr.Dataset(data, coords)


def _chart_variables(pole):
    """Return the stabilisation chart as variables over `pole`."""
    chart = pole.chart
    frequency = np.abs(chart.pole) / (2.0 * np.pi)
    stable = {
        "frequency": chart.stable_frequency,
        "damping": chart.stable_damping,
        "participation": chart.stable_participation,
    }
    variables = {
        f"chart_stable_{name}": (
            "pole",
            flag.astype(np.int8),
            {"units": "1", "long_name": f"stable in {name}"},
        )
        for name, flag in stable.items()
    }
    return variables | {
        "chart_order": (
            "pole",
            chart.order.astype(np.int16),
            {"units": "1", "long_name": "polynomial order"},
        ),
        "chart_frequency": (
            "pole",
            frequency,
            {"units": "Hz", "long_name": "frequency of the pole"},
        ),
        "chart_damping_ratio": (
            "pole",
            -chart.pole.real / np.abs(chart.pole),
            {"units": "1", "long_name": "damping ratio of the pole"},
        ),
        "chart_orders_taken": (
            "taken",
            np.array([pole.order], dtype=np.int16),
            {"units": "1", "long_name": "order whose pole was taken"},
        ),
    }


def _shape_variables(measured, match):
    """Return the deflection shape and its MAC over k as variables."""
    turned = measured.shape * np.exp(-0.5j * np.angle(np.sum(measured.shape**2)))
    turned = turned if turned.real[np.argmax(np.abs(turned))] > 0.0 else -turned
    return {
        "ods_re": (
            "line_point",
            turned.real,
            {"units": "1", "long_name": "operational deflection shape, part in phase"},
        ),
        "ods_im": (
            "line_point",
            turned.imag,
            {"units": "1", "long_name": "operational deflection shape, part in quadrature"},
        ),
        "singular_value": (
            "value",
            measured.singular_values,
            {"units": "1", "long_name": "singular value over the first"},
        ),
        "ods_band": (
            "edge",
            np.array(measured.band_Hz),
            {"units": "Hz", "long_name": "band of the shape"},
        ),
        "mac_k": ("mac_k", match.k_grid, {"units": "N m-1", "long_name": "support stiffness"}),
        "mac": (
            "mac_k",
            match.mac_grid,
            {"units": "1", "long_name": "MAC with the linear tube's shape"},
        ),
        "best_mac": ((), match.mac, {"units": "1", "long_name": "largest MAC"}),
    }
