"""Colours, fonts, sizes and icons of the window, and its style."""
