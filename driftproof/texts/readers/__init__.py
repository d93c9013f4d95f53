"""Readers of text formats: prose, listings and numbers as people see them, with their places in the file."""
