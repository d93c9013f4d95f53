"""The sub-commands of the command line; `listing` says which module has which of them."""
