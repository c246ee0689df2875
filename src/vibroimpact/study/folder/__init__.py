"""A folder for a study of one's own: the workflow that the package brings, laid out for editing."""
