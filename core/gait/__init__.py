"""What does walking look like? One clinical question per module; no joint is identified and no angle computed here."""
