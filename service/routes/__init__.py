"""One file a noun; routes translate between HTTP and coordination and decide nothing."""
