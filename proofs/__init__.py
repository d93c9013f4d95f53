"""What the lesson says: one test per claim, a ledger of what each is worth, and the values that the text may print."""
