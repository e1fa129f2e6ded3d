"""Cameras: which there are, and their frames, taken by a process of its own."""
