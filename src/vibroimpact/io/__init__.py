"""Files, units, origin of results: no physics, and no import of the other packages."""
