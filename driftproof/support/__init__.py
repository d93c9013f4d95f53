"""Files, packages, names: what every room needs and nobody in the field would ask about."""
