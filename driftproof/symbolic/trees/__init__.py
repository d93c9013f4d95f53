"""Rooted trees and what is counted on them: order conditions, B-series, modified equations; all exact."""
