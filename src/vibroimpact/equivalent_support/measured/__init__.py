"""The equivalent support of a measured structure, by the methods that a study uses."""
