"""Ground truth and senses: a simulated fleet in a building, and a client that speaks only HTTP."""
