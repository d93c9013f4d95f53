"""Forms of states: how a step takes and returns numbers, in arrays, records, objects, lists, or what it writes into."""
