"""The page that compares many sessions of the library, and its controller."""
