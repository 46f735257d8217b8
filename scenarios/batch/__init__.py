"""Many missions at once: suites, runs in processes of their own, statistics, figures."""
