"""Claims about the numbers of a text: reading them, and checking a text against them."""
