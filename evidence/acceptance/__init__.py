"""How often verdicts are right, on campaigns in which another code hid an effect."""
