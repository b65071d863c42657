"""Runs on disk: carried out, carried on, and read again."""
