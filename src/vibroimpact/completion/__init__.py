"""From measured periodic records to a completed model: identified modes, local laws fitted on some
levels and tried on others, a name.
"""
