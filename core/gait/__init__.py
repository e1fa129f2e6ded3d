"""What does walking look like? One clinical question per module; nothing here identifies a joint or computes its angle."""
