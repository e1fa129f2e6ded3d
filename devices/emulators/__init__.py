"""Sensors that are not there: they speak the published protocols through real ports and sockets.

For tests, and to try the application without hardware. Nothing else in the project may need them.
"""
