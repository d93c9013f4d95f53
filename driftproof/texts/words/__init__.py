"""The words of a text: methods, settings, problems, facts and tables that it names, and what they say of a number."""
