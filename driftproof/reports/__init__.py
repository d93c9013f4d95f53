"""Answers to be looked at: pages, figures and studies."""
