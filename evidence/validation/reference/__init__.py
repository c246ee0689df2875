"""Reference cases of the field: closed forms and published numbers."""
