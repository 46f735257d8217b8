"""Simultaneous localization and mapping, with one robot and with several (thesis chapter 4)."""
