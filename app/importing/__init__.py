"""Files of other programs, read in a process that may touch nothing else, and drafts kept until they are imported."""
