"""Partitions a partially explored map into rooms, corridors and parts of them (thesis 2.4)."""
