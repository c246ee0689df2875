"""Convergence with mesh, contact points, step, modes and averages."""
