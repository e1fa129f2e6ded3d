"""The patient is still: page, step, and what is computed of the standing."""
