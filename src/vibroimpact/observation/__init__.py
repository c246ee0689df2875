"""A measured campaign as a model sees it: sensors, forces, signals, features, simulated records."""
