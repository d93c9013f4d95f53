"""Exact facts about one-step methods, derived over polynomial rings and certified by balls."""
