"""Scenarios: maps, missions, suites, reports and the `marsupial` command."""
