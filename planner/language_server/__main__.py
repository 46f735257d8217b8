"""`python -m planner.language_server`: the server over stdio."""

from planner.language_server.server import serve

serve()
