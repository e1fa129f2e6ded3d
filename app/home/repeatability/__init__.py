"""The page of the clinic's own error figures, and its controller."""
