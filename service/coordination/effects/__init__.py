"""What events do to a mission."""
