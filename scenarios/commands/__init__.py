"""Commands that run missions, benchmarks and plans on maps."""
