"""Runs: carried out, kept in a directory, read and summed up again."""
