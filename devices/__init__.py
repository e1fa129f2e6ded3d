"""How do bytes become samples?

Sensors, simulated patients and files of other programs end here as `core.samples`. Nothing in this package knows what
the numbers mean for a patient.
"""
