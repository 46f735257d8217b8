"""Exploration with marsupial teams: carriers deploy and fetch rovers (Wurm, section 3.4)."""
