"""Simulated parks, laser remission and vibration, with known truth."""
