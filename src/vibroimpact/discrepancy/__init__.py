"""Where simulation and measurement disagree, and what the lowest record tells of it."""
