"""Exploration of unknown buildings: the service's strategies in the kinematic simulation."""
