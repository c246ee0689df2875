"""Words, tables, pages and figures: of a study, of a measured tube, of a diagnosis.

`figures` draws; the pages import no library of plots. May import everything but the stages.
"""
