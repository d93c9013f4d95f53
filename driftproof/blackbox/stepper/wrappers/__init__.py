"""Wrappers ready to paste, for steps that cannot be opened as they are; each is tried out before it is shown."""
