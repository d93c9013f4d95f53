"""Error against work: what methods reach on a problem, at how many evaluations, in what time."""
