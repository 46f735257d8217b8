"""Where planning runs: the executor port and its implementations."""
