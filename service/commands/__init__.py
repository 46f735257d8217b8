"""Commands that the `marsupial` command line takes from this room."""
