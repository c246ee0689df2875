"""All figures of a discrepancy run."""

from __future__ import annotations

from .map import map_figure
from .place import place_figure
from .ranking import profiles_figure, ranking_figure
from .spectra import spectra_figure


def discrepancy_figures(results, config=None):
    """Return the Sheets of Results, in the order of the page.

    config: the checked Config of the model, None where there is none.

    A sheet without content says so and has no table.
    """
    effects = results.verdict.shown_effects()
    named = [effect.id for effect in effects]
    after = results.after if effects else None  # where nothing is added, it is the same again
    return [
        *place_figure(config, results.before, effects),
        *map_figure(results.before, after),
        *spectra_figure(results.before, after, results.verdict.regions),
        *ranking_figure(results.ranking, named),
        *profiles_figure(results.candidates, effects),
    ]
