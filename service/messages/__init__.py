"""What travels over HTTP, checked once at the border; docs/fleet-protocol.md tells it in words."""
