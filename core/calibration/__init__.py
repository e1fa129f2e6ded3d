"""How do the sensors sit on the joints? The robust identification, one step per module."""
