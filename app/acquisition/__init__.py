"""From what sensors send now to the journal, the screen's buffers and the live estimate. No Qt, no gait.

One thread reads each source, journal first; one more thread works on what is new. None ever waits for the screen, the
database or Rerun. What is shown live is a preview: on stop everything comes from the journal.
"""
