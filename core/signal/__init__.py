"""Samples made even, turned and paired: tracks on one clock, their orientation, and what reception did to them."""
