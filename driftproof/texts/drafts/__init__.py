"""Drafts of claims: what the numbers of a text look like, what they are slips for, and the phrases that name them."""
