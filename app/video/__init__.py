"""Video of a walk on the screen: the player, and what it is moved by."""
