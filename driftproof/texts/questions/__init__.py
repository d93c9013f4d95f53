"""Questions about methods and runs in a small language: parsed, answered exactly, written in a named style."""
