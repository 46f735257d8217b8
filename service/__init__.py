"""The coordination service: missions over HTTP, planned, dispatched, stored and replanned."""
