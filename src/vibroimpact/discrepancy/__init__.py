"""Where simulation and measurement disagree: misfit, map, invariances, energy, completed model."""
