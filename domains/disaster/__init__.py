"""Disaster recovery: explorers visit targets, clearers remove blockades (Wurm, section 3.5)."""
