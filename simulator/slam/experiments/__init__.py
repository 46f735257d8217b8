"""Experiments of thesis chapter 4 in worlds of their own, and on public data."""
