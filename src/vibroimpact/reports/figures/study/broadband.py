"""Broadband PSD: target, best linear equivalent and range of linear responses (figure 12)."""

import numpy as np
from scipy.signal import find_peaks

from vibroimpact.reports.figures.plot import Axis, ColourBar, Panel, Plot, Series
from vibroimpact.reports.figures.style import GREEN, gap_label, number, ordered_colours

from .cases_of_gap import first_seed, transition_load
from .linear_limits import contact_stiffness
from .psd_table import driven_sensor, inside, linear_psds

RANGE_MEMBERS = 9
# Of a comparison of peaks: bins that are averaged, least height of a peak over its valleys in ln of
# the PSD, and the bins to both sides in which the other spectrum may have its own.
SMOOTHED, PROMINENCE, NEAR_BINS = 5, np.log(4.0), 20


def figure_12_broadband(config, model, curves, spectra, rows):
    """Return the Plot of the broadband fit at the load of the widest peak and at the largest one.

    curves, spectra: {Case: Dataset} of one gap. rows: table rows of that gap.
    """
    sensor = driven_sensor(config, config.identification.broadband.point)
    caption = (
        f"PSD of displacement at {sensor}, gap"
        f" {gap_label(config, next(iter(curves)).gap_m)}, first"
        " seed: simulated with contact (black), and the linear tube whose bilateral support (k, c)"
        " correlates best with it over the band (green). Thin, coloured: linear tubes with other"
        " stiffnesses, no damping added, under the same force. Left: the load at which the main"
        " peak is widest; right: the largest load. Above: the largest factor between both at a"
        " peak."
    )
    cases = first_seed(curves)
    stiffness = np.geomspace(
        config.identification.stiffness_range_N_per_m[0], contact_stiffness(model), RANGE_MEMBERS
    )
    panels = {}
    for load in sorted({transition_load(rows), max(cases)}):
        case = cases[load]
        own = [row for row in rows if row["load_rms_N"] == load and row["seed"] == case.seed]
        found = [row for row in own if row["method"] == "broadband"]
        files = curves[case], spectra[case]
        panels[f"{load:g} N"] = _panel(config, model, files, stiffness, found)
    title = "Spectrum with contact and of the best linear tube"
    bar = ColourBar("support_stiffness_N_per_m", stiffness[0], stiffness[-1], log=True, curves=True)
    return Plot("figure_12_broadband", title, caption, panels, size=(7.6, 4.6), colour_bars=[bar])


def _panel(config, model, files, stiffness, found):
    """Return the Panel of range, target and best member for one load.

    files: (estimates, spectra) of the case. found: its rows of the broadband comparison.
    """
    fitted, spectrum = files
    sensor = driven_sensor(config, config.identification.broadband.point)
    band = config.identification.broadband.band_Hz
    load = float(spectrum.attrs["load_rms_N"])
    kept = inside(spectrum["frequency"].values, band)
    frequency = spectrum["frequency"].values[kept]
    target = spectrum["psd_displacement_mean"].sel(sensor=sensor).values[kept].astype(float)
    members = linear_psds(config, model, sensor, stiffness, frequency) * load**2
    colours = ordered_colours(stiffness)
    items = [
        Series("linear", frequency, psd, {"k_N_per_m": k}, colour=colours[k], width=0.6)
        for k, psd in zip(stiffness, members, strict=True)
    ]
    items.append(Series("target", frequency, target, label="with contact (target)", width=1.0))
    k, c = (found[0][name] for name in ("k_N_per_m", "c_N_s_per_m")) if found else (np.nan, np.nan)
    damping = f"c = {number(c)} N s/m" if np.isfinite(c) else "c not resolved"
    words = f"k = {number(k)} N/m, {damping}" if np.isfinite(k) else "no k resolved"
    words = "each support with its own k and c" if len(found) > 1 else words
    title = f"load {load:.3g} N RMS\n{words}"
    if "broadband_curve" in fitted:
        place, best = (fitted[name].values for name in ("broadband_frequency", "broadband_curve"))
        label = f"best linear, correlation {float(fitted['best_correlation']):.3f}"
        items.append(Series("best linear", place, best, label=label, colour=GREEN, width=2.0))
        factor = peak_factor(np.interp(place, frequency, target), best)
        title += f"\npeaks within a factor of {factor:.1f}"
    levels = Axis("psd_m2_per_Hz", True, 0.05 * target.min(), 30.0 * target.max())
    return Panel(Axis("frequency_Hz", False, *band), levels, items, title, legend="lower left")


def peak_factor(target, best):
    """Return the largest factor between two PSDs (bin,) at the peaks of either; 1 for no peak.

    The target is smoothed over SMOOTHED bins; a peak is compared with the largest value near it.
    """
    window = np.ones(SMOOTHED) / SMOOTHED
    levels = [np.log(np.convolve(psd, window, mode="valid")) for psd in (target, best)]
    places = np.concatenate([find_peaks(level, prominence=PROMINENCE)[0] for level in levels])
    factors = [1.0]
    for place in places:
        near = slice(max(place - NEAR_BINS, 0), place + NEAR_BINS + 1)
        factors.append(float(np.exp(abs(levels[0][near].max() - levels[1][near].max()))))
    return max(factors)
