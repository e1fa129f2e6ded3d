"""Database of the library. One schema for an encrypted SQLite file and for a clinic's PostgreSQL.

`models` has the tables, `migrations` how they came to be, `engine` opens, locks and translates trouble into sentences.
Only `app.storage` comes here; everyone else asks `app.storage.library`.

What writes takes the one write lock first, on both databases: what it then reads nobody else can change before it
writes, the audit's numbers have no gaps, and nothing ever deadlocks. A clinic writes a few times a minute.
"""
