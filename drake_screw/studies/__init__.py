"""Studies: many runs of a scenario, shared out among processes, and what they show."""
