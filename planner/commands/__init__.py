"""Commands of the planner; `scenarios.cli` registers them."""
