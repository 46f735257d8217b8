"""Exploration of unknown maps: targets on frontiers, and who goes to which."""
