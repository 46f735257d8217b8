"""The planner's commands with the attachments of this project: `--map` gives them their world."""

from planner.commands.compile_attachments import compile_attachments_command
from planner.commands.plan import plan_command
from planner.commands.validate import validate_command
from scenarios.map_attachments import map_attachments

plan = plan_command(map_attachments)
validate = validate_command(map_attachments)
compile_attachments = compile_attachments_command(map_attachments)
