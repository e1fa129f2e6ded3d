"""What was recorded, byte for byte, as it came: written so that nothing is lost, read back whatever happened.

A journal is one file: a header, then records, then a footer where it was stopped cleanly. A recording is one journal or
several, for a journal is never appended to: what resumes after a stop or a crash opens the next segment, under a key of
its own. The header holds no names; all else is sealed, except in the demonstration's library, which has no keys.

`writer` is for the recording of sensors and imports, `reader` gives the records back, `decoding` makes samples of them.
"""
