"""Texts held to claims about what each of their numbers is: checked, covered, drafted."""
