"""Whether the equivalent linear tube predicts what it was not fitted on."""
