"""Exploration of unknown buildings: the service's strategies at work in the kinematic simulation."""
