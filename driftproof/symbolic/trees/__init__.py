"""Rooted trees: order conditions, B-series, modified equations and algebraic stability, all exact."""
