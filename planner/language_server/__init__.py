"""A language server for PDDL 2.1 with PDDL/M modules, over the planner's own reader."""
