"""Steps on other systems than the oscillator, built in or given, beside the steps of a method on the same system."""
