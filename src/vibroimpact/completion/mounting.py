"""Equivalent stiffness and damping of a mounting against level, by the three methods of the paper,
on a measured structure.

The family of linear models is that of completion.family: identified modes and a bilateral support
(k, c) between the points of the mounting, k = c = 0 at the reference level. For each level the
member is found which has the pole of the peak (peak), the deflection shape round it (ods), and the
spectra of all channels in the band (broadband); each by itself, so that their agreement means
something. Source: Thenint, Balmes, Corus 2012, section 4; here the force was measured, and
responses per force take the place of output spectra.
"""

import numpy as np
from scipy.optimize import minimize, minimize_scalar

from vibroimpact.identify.ods import mac

from .family import fit_family
from .store import modes_of
from .study import row_of

SHAPE_POWER = 1.0 / 25.0  # of the peak: lines above it show the shape
# of the change of stiffness of the highest level: methods that agree within it are called
# consistent
CONSISTENT = 0.3
COLUMNS = (
    "level",
    "load_rms_N",
    "split",
    "method",
    "k_N_per_m",
    "c_N_s_per_m",
    "frequency_Hz",
    "damping_ratio",
    "mac",
    "motion_rms_m",
    "quality",
)


def mounting_table(levels, study, linear):
    """Return (rows of the table of COLUMNS, Family) for the mounting of a study; linear: values of
    linear_models.

    k and c are changes against the lowest level. The shape alone tells no damping: its c is that of
    the pole, and empty is written (NaN).
    """
    base = modes_of(linear["base"])
    row = np.array(row_of(study, study.mounting, base.names))
    fitted = [level for level in levels if level.split == "fit"]
    family = fit_family(base, row, fitted, study.band_Hz)
    rows = []
    for level in levels:
        modes = modes_of(linear["refitted"][level.name])
        place, ratio, pole = peak_pole(modes, study.peak_Hz)
        lines = np.flatnonzero(level.excited(study.band_Hz))
        found = {"peak": support_of_pole(family, pole)}
        likeness = np.nan
        if len(base.names) > 1:  # one channel has no shape
            stiffness, likeness = _by_shape(family, level, study, found["peak"])
            found["ods"] = (stiffness, np.nan)
        found["broadband"] = _by_spectra(family, level, lines, found["peak"])
        if level in fitted:
            found["frf"] = family.k[fitted.index(level)], family.c[fitted.index(level)]
        for method, (k, c) in found.items():
            damping = found["peak"][1] if np.isnan(c) else c
            motion = family.motion(level.frequency[lines], k, damping) * level.force[lines]
            rows.append(
                {
                    "level": level.name,
                    "load_rms_N": level.load_rms,
                    "split": level.split,
                    "method": method,
                    "k_N_per_m": k,
                    "c_N_s_per_m": c,
                    "frequency_Hz": place,
                    "damping_ratio": ratio,
                    "mac": likeness if method == "ods" else np.nan,
                    "motion_rms_m": float(np.sqrt(2.0 * np.sum(np.abs(motion) ** 2))),
                    "quality": "",
                }
            )
    return _with_quality(rows), family


def peak_pole(modes, band_Hz):
    """Return (frequency Hz, damping ratio, pole rad/s) of the mode with the largest peak among
    those in a band.
    """
    inside = np.flatnonzero(
        (modes.frequency >= band_Hz[0]) & (modes.frequency <= band_Hz[1]) & ~modes.residual
    )
    if inside.size == 0:
        raise ValueError(f"no mode was identified between {band_Hz[0]:g} and {band_Hz[1]:g} Hz")
    height = (
        np.linalg.norm(modes.shapes[inside], axis=1)
        * np.abs(modes.shapes[inside, modes.drive])
        / modes.damping_ratio[inside]
    )
    mode = inside[np.argmax(height)]
    omega, ratio = modes.omega[mode], modes.damping_ratio[mode]
    return (
        float(modes.frequency[mode]),
        float(ratio),
        complex(-ratio * omega, omega * np.sqrt(1.0 - ratio**2)),
    )


def support_of_pole(family, pole):
    """Return (k N/m, c N s/m) of the member of a family that has a pole (rad/s): k + pole c = -1 /
    (receptance of the support at the pole).
    """
    modes = family.modes
    along = modes.shapes @ family.row
    support = -1.0 / np.sum(along**2 / (pole**2 + pole * modes.damping + modes.omega**2))
    c = support.imag / pole.imag
    return float(support.real - pole.real * c), float(c)


def _by_shape(family, level, study, near):
    """Return (k, MAC): the stiffness whose member has the level's own deflection shape, its damping
    that of the pole.
    """
    lines = np.flatnonzero(level.excited(study.peak_Hz))
    power = np.sum(np.abs(level.response[:, lines]) ** 2, axis=0)
    lines = lines[power > SHAPE_POWER * power.max()]
    frequency = level.frequency[lines]
    measured = _first_vector(level.response[:, lines])

    def unlike(k):
        return 1.0 - mac(
            measured, _first_vector(family.frf(frequency, k, near[1]) * level.force[lines])
        )

    reach = max(abs(near[0]), 0.1 * np.abs(family.k).max())
    grid = near[0] + np.linspace(-1.5, 1.5, 61) * reach
    best = grid[int(np.argmin([unlike(k) for k in grid]))]
    found = minimize_scalar(
        unlike, bounds=(best - 0.05 * reach, best + 0.05 * reach), method="bounded"
    )
    return float(found.x), float(1.0 - found.fun)


def _by_spectra(family, level, lines, near):
    """Return (k, c) of the member whose amplitudes at all lines and channels are nearest to the
    measured ones, relative to each channel.
    """
    measured = np.abs(level.response[:, lines])
    size = np.sqrt(np.sum(measured**2, axis=1, keepdims=True))
    unit = np.array([max(np.abs(family.k).max(), 1.0e-9), max(np.abs(family.c).max(), 1.0e-9)])

    def missed(values):
        k, c = values * unit
        return float(
            np.sum(
                (
                    (
                        np.abs(family.frf(level.frequency[lines], k, c) * level.force[lines])
                        - measured
                    )
                    / size
                )
                ** 2
            )
        )

    found = minimize(
        missed,
        np.array(near) / unit,
        method="Nelder-Mead",
        options={"xatol": 1.0e-4, "fatol": 1.0e-8},
    )
    return tuple(float(value) for value in found.x * unit)


def _first_vector(motion):
    """First singular vector (channel,) of motion (channel, line)."""
    return np.linalg.svd(motion, full_matrices=False)[0][:, 0]


def _with_quality(rows):
    """The rows with a word each: consistent, apart, or reference, by the spread of the three
    methods' k at a level.
    """
    size = max(abs(row["k_N_per_m"]) for row in rows if row["method"] == "peak")
    for row in rows:
        others = [
            each["k_N_per_m"]
            for each in rows
            if each["level"] == row["level"] and each["method"] in ("peak", "ods", "broadband")
        ]
        distance = abs(row["k_N_per_m"] - np.median(others))
        row["quality"] = "consistent" if distance <= CONSISTENT * size else "apart"
    return rows
