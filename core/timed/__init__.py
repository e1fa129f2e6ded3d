"""Timed tests: walks of a set way or time and rises from a chair, timed by the motion itself or by a key.

Events, orientations and distances of each foot come from `core.gait`; what is drawn on a screen or typed by a person
does not belong here.
"""
