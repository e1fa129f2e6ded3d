"""Video of a walk: its clips, and the offset between their clock and that of the samples."""
