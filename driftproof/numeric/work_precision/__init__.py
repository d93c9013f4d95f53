"""Error against work: the errors that methods reach on a problem, with how many evaluations, in what time."""
