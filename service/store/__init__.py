"""The event log in a database: what is acknowledged is on disk."""
