"""Missions: their state as a fold over events, the strategies, and the loop that replans."""
