"""The study: its cases, their simulation, and the agreement of the identification methods."""
