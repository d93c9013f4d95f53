"""Error against work, measured for our methods and other packages, as tables and figures."""
