"""Every compiled function of vibroimpact. `march` states the equations of a step and holds the loop
over the steps; `compiled` says how the machine code is cached.
"""
