"""Exit codes of the service's commands; the same numbers as for every `marsupial` command."""

INPUT_ERROR = 31
"""a file, a database or an argument's value is not usable"""
USAGE_ERROR = 36
"""options that do not go together, or that do not exist"""
