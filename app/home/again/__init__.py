"""Stored sessions analysed again after the software changed."""
