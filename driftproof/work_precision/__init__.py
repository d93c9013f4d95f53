"""Error against work, measured beside other packages: the study, its report and its figure."""
