"""Simulated people with known angles, and recordings replayed, as sources of the bytes a sensor would send."""
