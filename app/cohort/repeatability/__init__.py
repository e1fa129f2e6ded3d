"""A clinic's own study of repeatability: whose sessions count, what was found, and its table and files."""
