"""Files of recordings, ours and other vendors': one module per format."""
