"""From a scenario to the objects that carry it out."""
