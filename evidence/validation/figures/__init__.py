"""The figures of the validation."""
