"""A library that the stations of a clinic share: rows on a PostgreSQL server, journals in a place that all reach.

Each station has a folder of its own, which looks like a library's (`station`): it names the server, keeps a copy of who
may log in (`key_slots`), and holds what is being recorded. A journal is always written on the station's own disk; when
it is stopped it is handed over to the shared place (`journal_store`, `handing_over`), verified, and only then becomes a
copy that may go. So a station goes on recording while the server does not answer, and hands over once it does.
`moving` brings a single library to the server, and back.
"""
