"""Which sensors there are and where each is worn: page and parts, step, sources, what is computed of shaking."""
