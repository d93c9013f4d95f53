"""What changed between two files of values: found, and told."""
