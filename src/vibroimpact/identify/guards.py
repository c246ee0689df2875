"""Doubts about an estimate beyond its standard error: the texts of the column `flag`.

A flag changes no value, except that a run whose energy balance is open has no resolved ones. A
flagged estimate takes no part in the recommended values. The column `caution` holds remarks on a
case, whatever the method.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from vibroimpact.identify.linear.poles import first_pole, pole_of
from vibroimpact.integration.energy_limit import energy_flag
from vibroimpact.reduction.basis_accuracy import STIFFNESSES
from vibroimpact.reduction.modal_model import ModalModel

from .estimate import PEAK_METHODS, Estimate, flagged, joined
from .peak import LEVELS, PeakFit, level_edges

# Degrees of freedom of a spectral bin. The scatter of the segments has half of them less one, so
# that a standard error from it is known within 40 % at 8, within 25 % at the 18 of the default.
FEWEST_AVERAGES = 8.0
STIFFEST_CHECKED = max(STIFFNESSES)  # N/m, of the comparison of reduced with full frequencies
FLANKS = LEVELS["peak_25th"]  # the part of a peak that has a weight in every fit
SAME_POLE = 1.0e-3  # relative; the inverse is exact, so that a larger difference is another mode
GUARDED = ("contact_fraction", "stress_flag", "stress_peak")  # of a record, if it has them
FROM_POLES = (*PEAK_METHODS, "lscf")
FROM_SPECTRA = (*FROM_POLES, "ods", "broadband")


def guarded(
    estimates: Iterable[Estimate],
    record: xr.Dataset | None,
    averages: float,
    search_Hz: Sequence[float],
    unusable: str = "",
) -> list[Estimate]:
    """Return the estimates of one case with the flags and cautions that any method can have.

    record: with the residuals of the energy balance, if it has them; None for a measured case.
    averages: effective degrees of freedom of a bin.
    search_Hz: the band searched for the main peak.
    unusable: which channels the methods can not use; a reason for unresolved values.
    """
    record = xr.Dataset() if record is None else record
    energy = energy_flag(record)
    caution = joined(few_averages(averages), over_stress(record))
    found = []
    for estimate in estimates:
        if estimate.method in FROM_SPECTRA and estimate.quality == "unresolved":
            estimate = replace(estimate, note=joined(unusable, estimate.note))
        if estimate.method in FROM_POLES:
            estimate = flagged(estimate, outside_search(estimate.frequency, search_Hz))
        if estimate.method != "statistical_linearisation":  # it does not see the record
            estimate = _without_value(estimate, energy)
        touching = contact_fraction(record, estimate.group)
        estimate = replace(estimate, caution=caution, contact_fraction=touching)
        found.append(flagged(estimate, beyond_checked(estimate.k)))
    return found


def unusable_channels(spectra: xr.Dataset) -> str:
    """Return which sensors along the force do not move or have no finite spectra, or nothing.

    spectra: dataset of study.case_spectra.
    """
    parts = spectra["sensor_spectra_re"].values, spectra["sensor_spectra_im"].values
    size = np.abs(parts[0]).max(axis=(1, 2)) + np.abs(parts[1]).max(axis=(1, 2))
    names = spectra["driven_sensor"].values
    still = [str(name) for name, value in zip(names, size, strict=True) if value == 0.0]
    wrong = [str(name) for name, value in zip(names, size, strict=True) if not np.isfinite(value)]
    texts = [f"no motion at {', '.join(still)}"] if still else []
    return "; ".join(texts + ([f"no finite spectra at {', '.join(wrong)}"] if wrong else []))


def contact_fraction(record: xr.Dataset, group: str) -> float:
    """Return the share of time in contact of the support of a group that is touched most.

    NaN if the record does not have it.
    """
    if "contact_fraction" not in record:
        return np.nan
    values, names = record["contact_fraction"].values, group.split("+")
    if "support" in record.coords:
        inside = np.isin(record["support"].values.astype(str), names)
        values = values[inside] if inside.any() else values
    return float(values.max(initial=0.0))


def over_stress(record: xr.Dataset) -> str:
    """Return that the peak stress of a record is above the limit of the study, or nothing."""
    if not record.get("stress_flag", 0):
        return ""
    peak = 1e-6 * float(record["stress_peak"].max())
    return f"the peak stress, {peak:.0f} MPa, is above record.stress_limit_Pa"


def _without_value(estimate: Estimate, reason: str) -> Estimate:
    """Return the estimate flagged and without k and c, or as it is for an empty reason."""
    if not reason:
        return estimate
    note, flag = joined(reason, estimate.note), joined(estimate.flag, reason)
    lost = replace(estimate, k=np.nan, k_standard_error=np.nan, k_bound=np.nan, flag=flag)
    return replace(lost, c=np.nan, c_standard_error=np.nan, quality="unresolved", note=note)


def few_averages(averages: float) -> str:
    """Return why a spectrum with few degrees of freedom is flagged, or an empty text."""
    if averages >= FEWEST_AVERAGES:
        return ""
    return (
        f"{averages:.2g} degrees of freedom of a spectral bin, fewer than {FEWEST_AVERAGES:g}: the"
        " scatter of the segments does not confirm the standard errors"
    )


def outside_search(frequency: float, search_Hz: Sequence[float]) -> str:
    """Return that a pole lies outside the band in which the main peak was sought, or nothing.

    frequency: Hz, NaN for no pole.
    """
    low, high = search_Hz
    if np.isnan(frequency) or low < frequency < high:
        return ""
    return f"the pole at {frequency:.4g} Hz is outside peak_search_Hz, {low:g} to {high:g} Hz"


def peak_not_crossed(fit: PeakFit, band_Hz: Sequence[float]) -> str:
    """Return that a peak does not fall to 1/FLANKS of its height inside the band, or nothing.

    The fit then takes bins without power for a flank. It is asked of all levels, because such a fit
    is too narrow: its own half-power points lie inside the band and the true ones do not.

    band_Hz: that in which the force has power and the spectrum has bins.
    """
    low, high = band_Hz
    edges = level_edges(fit.frequency, fit.damping_ratio, FLANKS)
    outside = [edge for edge in edges if not low <= edge <= high]
    if not outside:
        return ""
    where = " and ".join(f"{edge:.3g} Hz" if edge > 0.0 else "no frequency" for edge in outside)
    return (
        f"the fitted peak falls to 1/{FLANKS:g} at {where}, outside the band of {low:g} to"
        f" {high:g} Hz: its width was not seen on both sides"
    )


def other_mode(model: ModalModel, k: float, c: float, pole: tuple[float, float]) -> str:
    """Return that a pole belongs to another mode than the first of the linear tube, or nothing.

    The first mode is followed from c = 0. If modes cross on the way, k and c have the pole, but
    not for the mode that they were sought for.

    k, c: N/m and N s/m.
    pole: undamped frequency in Hz and damping ratio.
    """
    wanted = pole_of(*pole)
    try:
        first = first_pole(model, k, c)
    except ValueError as error:
        return f"mode crossing: {error}"
    if abs(first - wanted) <= SAME_POLE * abs(wanted):
        return ""
    return (
        f"mode crossing: with this k and c the first mode is at {abs(first) / (2 * np.pi):.4g} Hz,"
        f" the pole of {pole[0]:.4g} Hz is that of another mode"
    )


def beyond_checked(k: float) -> str:
    """Return that k is stiffer than any support at which the basis was checked, or nothing."""
    if np.isnan(k) or k <= STIFFEST_CHECKED:
        return ""
    return (
        f"k is beyond {STIFFEST_CHECKED:.2g} N/m, the stiffest support at which the reduced model"
        " was compared with the full one"
    )
