"""The equivalent support of any tube as a law of its free motion over the gap.

The equivalent support of a rattling tube is about the one that holds a linear tube to a motion of
the gap. The law makes this a number: on the support k, the linear tube with its modal damping alone
would move `held` gaps RMS at its plates, if the tube without supports would move `level` gaps.
`held` against `level` is taken from one study, and k of another tube then follows from its own
linear response. It approaches `level` if the tube hardly touches (k = 0), and about 1.5 if it
rattles. The damping is given as a loss factor, c omega / k with omega the first frequency on k.

displacement_law.json, the law that ships with the package, and its measured errors,
displacement_law_errors.csv, are made by the target `equivalent_law` of the workflow from the
default study and from the tubes of config/validation/other_tubes.yaml.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.identify.linear.modes import contact_matrix, driven_block
from vibroimpact.identify.linear.support_groups import driven_direction
from vibroimpact.identify.statistical_linearisation import power_in_band
from vibroimpact.io.records import read_text
from vibroimpact.reduction.modal_model import ModalModel

STEPS_PER_DECADE = 24  # of the stiffnesses at which the linear tube is computed
LOWEST_SHARE = 1.0e-6  # of the contact stiffness; a softer support counts as none
LAW_FILE = Path(__file__).with_name("displacement_law.json")
RATIOS = ("k_median", "k_low", "k_high", "c_median", "c_low", "c_high")


@dataclass(frozen=True)
class HeldTube:
    """The linear tube on its plates, against the support's stiffness.

    stiffness: (k,) N/m per support, ascending; the first stands for no support.
    motion: (k,) RMS displacement at the plates along the drive, in m per N RMS of the force.
    omega: (k,) rad/s, first frequency of the driven motion.
    """

    stiffness: np.ndarray
    motion: np.ndarray
    omega: np.ndarray

    def level(self, load_rms_N: float, gap_m: float) -> float:
        """Return the RMS displacement of the free tube at its plates, over the gap."""
        return float(self.motion[0] * load_rms_N / gap_m)

    def held(self, k: float, load_rms_N: float, gap_m: float) -> float:
        """Return the RMS displacement at the plates on a support k in N/m, over the gap."""
        x = np.log(self.stiffness)
        motion = np.exp(np.interp(np.log(max(k, self.stiffness[0])), x, np.log(self.motion)))
        return float(motion * load_rms_N / gap_m)

    def stiffness_at(self, held: float, load_rms_N: float, gap_m: float) -> float:
        """Return the softest support in N/m on which the tube moves no more than `held` gaps.

        It is at most the contact stiffness.
        """
        y = np.log(self.motion * load_rms_N / (gap_m * held))
        first = int(np.argmax(y <= 0.0)) if (y <= 0.0).any() else len(y) - 1
        if first == 0 or y[first] > 0.0:
            return float(self.stiffness[first])
        share = y[first - 1] / (y[first - 1] - y[first])
        x = np.log(self.stiffness)
        return float(np.exp(x[first - 1] + share * (x[first] - x[first - 1])))

    def first_omega(self, k: float) -> float:
        """Return the first frequency in rad/s on a support k in N/m."""
        return float(np.interp(np.log(k), np.log(self.stiffness), self.omega))


def held_tube(model: ModalModel, band_Hz: Sequence[float]) -> HeldTube:
    """Return the HeldTube of a model under a force of flat PSD in a band.

    The displacement is the root mean square over the plates of each one's mean; the damping is
    modal. Its integral over the band is in closed form (power_in_band). Values are NaN if a mode is
    overdamped.
    """
    contact = max(np.bincount(model.support_of_point, model.contact_stiffness))
    decades = int(np.ceil(-np.log10(LOWEST_SHARE)))
    stiffness = np.geomspace(LOWEST_SHARE * contact, contact, decades * STEPS_PER_DECADE + 1)
    modes = driven_block(model)
    support = contact_matrix(model)[modes]
    support = support @ support.T
    places, drive = plate_shapes(model)[modes], model.drive_shapes[modes, 0]
    motion, omega = np.zeros(stiffness.size), np.zeros(stiffness.size)
    for number, k in enumerate(stiffness):
        held = np.diag(model.omega[modes] ** 2) + k * support
        power, own, _ = power_in_band(held, model.damping[modes], places, drive, band_Hz)
        power = power / (band_Hz[1] - band_Hz[0])
        motion[number], omega[number] = np.sqrt(power.mean()), own[0]
    return HeldTube(stiffness, motion, omega)


def plate_shapes(model: ModalModel) -> np.ndarray:
    """Return (mode, support): mean displacement of each support's points along driven_direction."""
    along, weight = model.contact_shapes[:, :, driven_direction(model)], model.contact_weight
    own = [model.support_of_point == number for number in range(len(model.support_names))]
    return np.stack([along[:, points] @ weight[points] for points in own], axis=1)


@dataclass(frozen=True)
class DisplacementLaw:
    """RMS displacement of the held tube over the gap, and loss factor, against the free tube's.

    level, held, loss: (point,), level ascending.
    """

    level: np.ndarray
    held: np.ndarray
    loss: np.ndarray

    def inside(self, level: float) -> bool:
        """Return whether the law was fitted at this level."""
        return bool(self.level[0] <= level <= self.level[-1])

    def at(self, tube: HeldTube, load_rms_N: float, gap_m: float) -> tuple[float, float]:
        """Return (k in N/m, c in N s/m) per support of a tube at a load and gap."""
        x, places = np.log(tube.level(load_rms_N, gap_m)), np.log(self.level)
        held = float(np.exp(np.interp(x, places, np.log(self.held))))
        k = tube.stiffness_at(held, load_rms_N, gap_m)
        return k, float(np.interp(x, places, self.loss)) * k / tube.first_omega(k)


@dataclass(frozen=True)
class ShippedLaw:
    """A law with its measured errors.

    origin: of the law.
    errors: rows of law_errors.error_rows, ascending, the last one over all levels.
    """

    law: DisplacementLaw
    errors: tuple[dict[str, Any], ...]
    origin: dict[str, Any]

    def error_at(self, level: float) -> dict[str, float]:
        """Return the measured ratios of simulation to law at a level: k_median, k_low, k_high and
        those of c.

        They are interpolated in logarithms between the middles of the regions. The range from low
        to high includes 1, the tube of the fit.
        """
        regions = self.errors[:-1]
        middles = [0.5 * np.log(row["level_from"] * row["level_to"]) for row in regions]
        logs = {name: [np.log(row[name]) for row in regions] for name in RATIOS}
        x = np.log(level)
        error = {name: float(np.exp(np.interp(x, middles, own))) for name, own in logs.items()}
        for name in ("k", "c"):
            error[f"{name}_low"] = min(error[f"{name}_low"], 1.0)
            error[f"{name}_high"] = max(error[f"{name}_high"], 1.0)
        return error


@cache
def shipped_law(path: Path = LAW_FILE) -> ShippedLaw:
    """Return the law of a file that the workflow makes; that of the package by default."""
    content = json.loads(read_text(path))
    arrays = {name: np.array(content[name]) for name in ("level", "held", "loss")}
    return ShippedLaw(DisplacementLaw(**arrays), tuple(content["errors"]), content["origin"])
