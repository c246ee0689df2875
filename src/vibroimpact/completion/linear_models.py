"""The linear models of a campaign: identified at the lowest level, identified again at each, and
fitted to all fitted levels at once.
"""

import numpy as np

from vibroimpact.identify.modal_fit import identify_modes, refine_modes, relative_errors
from vibroimpact.spectra.periodic_lines import distortion

from .levels import levels_of, naming_split
from .store import modes_of, modes_values


def linear_models(campaign, study):
    """Return the linear models as plain values: names, kinds, `base` modes of the lowest fitted
    level, `refitted` {level name: modes} and `joint` modes of all levels that names are fitted to;
    `chart` of the base's poles; `distortion` {level name: what the lines tell}.
    """
    levels, names, kinds = levels_of(campaign)
    fitted = [level for level in levels if level.split == "fit"]
    drive = _index(names, study.drive)
    base, chart = identify_modes(
        fitted[0], study.band_Hz, kinds, names, drive, study.residual_modes
    )
    refitted = {
        level.name: modes_values(_identified_again(base, level, study, drive)) for level in levels
    }
    joint = refine_modes(base, naming_split(levels)[0], study.band_Hz)
    return {
        "study": study.name,
        "reference": fitted[0].name,
        "base": modes_values(base),
        "joint": modes_values(joint),
        "refitted": refitted,
        "chart": {
            "order": chart.order,
            "frequency_Hz": np.abs(chart.pole) / (2.0 * np.pi),
            "stable": chart.stable,
        },
        "distortion": {level.name: distortion(level, study.band_Hz) for level in levels},
    }


def _identified_again(base, level, study, drive):
    """The modes of a level: from poles of its own, or refined from the base's, whichever misses
    less.
    """
    tried = [refine_modes(base, [level], study.band_Hz)]
    try:
        tried.append(
            identify_modes(
                level, study.band_Hz, base.kinds, base.names, drive, study.residual_modes
            )[0]
        )
    except ValueError as error:
        print(f"{level.name}: no poles of its own, refined from the lowest level: {error}")
    return min(
        tried, key=lambda modes: float(np.sum(linear_errors(modes, level, study.band_Hz) ** 2))
    )


def linear_errors(modes, level, band_Hz):
    """Return (channel,) relative error of the linear response at a level over the excited lines."""
    lines = level.excited(band_Hz)
    return relative_errors(modes.frf(level.frequency[lines]) * level.force[lines], level, band_Hz)


def base_of(linear):
    """Return the IdentifiedModes of the lowest level from linear_models' values."""
    return modes_of(linear["base"])


def _index(names, wanted):
    if wanted not in names:
        raise ValueError(f"the drive's channel '{wanted}' is not among {', '.join(names)}")
    return names.index(wanted)
