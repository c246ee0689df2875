"""All figures of a diagnosis."""

from __future__ import annotations

import xarray as xr

from vibroimpact.config.schema import Config
from vibroimpact.figures.sheet import Sheet
from vibroimpact.verdict.content import Verdict

from .free_sensor import free_sensor_figure
from .holding import holding_figure
from .law import law_figure
from .place import place_figure
from .psd import psd_figure
from .ranking import ranking_figure


def diagnosis_figures(
    evidence: xr.Dataset, psd: xr.Dataset, verdict: Verdict, config: Config | None = None
) -> list[Sheet]:
    """Return the Sheets of a diagnosis, in the order of its page: as many for every verdict.

    evidence: of diagnosis.evidence.evidence_of, empty of a campaign that was refused. psd: see
    psd.psd_figure, empty alike. config: of the model, whose structure is drawn. A figure whose
    content the campaign can not give says why, and has no table.
    """
    return [
        *place_figure(config, evidence, verdict.shown_effects()),
        *holding_figure(evidence),
        *law_figure(evidence),
        *ranking_figure(verdict),
        *free_sensor_figure(evidence),
        *psd_figure(psd, verdict),
    ]
