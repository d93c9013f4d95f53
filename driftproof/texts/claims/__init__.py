"""Claims about the numbers of a text: checking them, measuring their coverage, drafting them."""
