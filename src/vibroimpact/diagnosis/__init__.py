"""Diagnosis: the model held to the measurement, what it lacks, and how sure that is.

Data flow one way: measurement -> held runs -> score -> fit of explanations -> decision ->
verification ->
verdict, whose content and file `verdict` holds. May import everything but study and reports.
"""
