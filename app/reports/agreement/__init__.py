"""Agreement of a session with an optical system: which walk is which trial, and what is written of it."""
