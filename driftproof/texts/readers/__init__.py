"""Files as their reader sees them: prose, listings and numbers, each character with its place in the file."""
