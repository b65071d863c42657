"""Pages: of a run as it goes on, of a lesson, of an attempt looked at, of a whole run."""
