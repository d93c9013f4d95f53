"""Texts with questions in them, rendered: Jinja in a sandbox, in a process of its own."""
