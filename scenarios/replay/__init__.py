"""A mission played again from its event log."""
