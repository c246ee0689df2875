"""The claims of the paper, each with its number and a verdict."""
