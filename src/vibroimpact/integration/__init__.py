"""Time integration: compiled kernels, the step of a mode, batches of cases, the output filter."""
