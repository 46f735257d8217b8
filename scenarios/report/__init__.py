"""The report of a mission: one self-contained HTML page with map, Gantt chart and tables."""
