"""The legs are moved freely: page, step, hints, and what is computed of the motion."""
