"""Words, tables and pages: of a study, of a measured tube, of a diagnosis."""
