"""The true solution of an initial value problem, enclosed: Taylor steps, stiff steps, and crossings of kinks."""
