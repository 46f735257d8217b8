"""Readers of public data sets; the sets themselves are not part of the project."""
