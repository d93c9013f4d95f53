"""Texts that nobody templated: their numbers, with places, held to claims about what each of them is."""
