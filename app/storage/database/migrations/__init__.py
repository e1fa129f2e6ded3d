"""How the tables came to be, step by step: one chain for SQLite and PostgreSQL. Steps are frozen once released."""
