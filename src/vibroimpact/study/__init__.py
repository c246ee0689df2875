"""The study: its cases, their simulation, and the agreement of the identification methods.

`wear` is the wear of a finished study, `folder` the workflow that a study runs on. Imports no
diagnosis, and nothing that draws.
"""
