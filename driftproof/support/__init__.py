"""Helpers without mathematics for all other folders: files, processes, messages, plain text and TOML."""
