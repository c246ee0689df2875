"""Time integration: the compiled kernel, the step of a mode, batches of cases, energies and the
output filter.
"""
