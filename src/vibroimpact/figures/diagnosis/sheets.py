"""All figures of a diagnosis."""

from __future__ import annotations

import xarray as xr

from vibroimpact.figures.sheet import Sheet
from vibroimpact.verdict.content import Verdict

from .free_sensor import free_sensor_figure
from .holding import holding_figure
from .law import law_figure
from .psd import psd_figure
from .ranking import ranking_figure


def diagnosis_figures(evidence: xr.Dataset, psd: xr.Dataset, verdict: Verdict) -> list[Sheet]:
    """Return the Sheets of a diagnosis, in the order of its page.

    evidence: of diagnosis.evidence.evidence_of. psd: see psd.psd_figure. A figure whose content the
    campaign can not give says why; the probabilities are left out where the verdict has none.
    """
    return [
        *holding_figure(evidence),
        *law_figure(evidence),
        *ranking_figure(verdict),
        *free_sensor_figure(evidence),
        *psd_figure(psd, verdict),
    ]
