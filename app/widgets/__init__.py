"""What pages are made of. A part is given the theme and its words, and knows nothing of gait but left and right."""
