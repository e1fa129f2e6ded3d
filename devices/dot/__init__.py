"""Movella (Xsens) DOT by Bluetooth LE: its messages, streams and memory, and sources of several of them.

What a message means belongs here, and in which order they are sent. How they get through the air is in
`transport/bluetooth.py`; a sensor that is not there is in `emulators/`. Nothing here was tried on hardware.
"""
