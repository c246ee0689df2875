"""What the lowest record tells: modes, sensors, linear effects, and whether the model fits it."""
