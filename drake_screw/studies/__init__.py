"""Studies: many runs of a scenario, to measure how many demonstrations they take."""
