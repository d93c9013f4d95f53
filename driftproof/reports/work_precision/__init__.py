"""Error against work, measured beside other packages, as tables and figures."""
