"""Integration methods as exact data: definitions, published tables, readers of users' files, and program texts."""
