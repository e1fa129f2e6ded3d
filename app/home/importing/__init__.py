"""The page that makes recordings of other programs' files, and its controller."""
