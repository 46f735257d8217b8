"""Domains and maps that the service keeps: checked on upload, versioned by content."""
