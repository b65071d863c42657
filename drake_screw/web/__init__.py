"""Pages: of a run as it goes on, where demonstrations are given, of an attempt, of a whole run."""
