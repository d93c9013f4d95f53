"""What is true: exact facts about one-step methods, derived over polynomial rings and certified by balls."""
