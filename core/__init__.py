"""What do the numbers mean?

Everything that turns samples into joint angles lives here, as plain functions over frozen data: no clock, no file, no
thread, no screen. Lengths are metres, angles radians, times seconds; degrees appear only where figures are printed.
"""
