"""Texts with values in them, from Jinja2 templates: sandboxed, bounded, and never with a blank for a number."""
