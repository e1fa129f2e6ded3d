"""Standing still: page, step, and what is computed of the standing."""
