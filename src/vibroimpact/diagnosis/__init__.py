"""Diagnosis: the model held to the measurement, the effects that it lacks, and their probability.

Data flow one way: measurement -> held runs -> score -> fit of explanations -> decision ->
verification ->
verdict, whose content and file `verdict` holds. May import everything but study and reports.
"""
