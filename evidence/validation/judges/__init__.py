"""Other codes that judge the same numbers."""
