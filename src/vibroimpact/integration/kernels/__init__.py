"""The compiled functions: `march` states the equations of a step and loops over the steps;
`compiled` says how machine code is cached.
"""
