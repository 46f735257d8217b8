"""Ground truth and senses: a simulated fleet in a building that knows a service by its protocol."""
