"""One module for each sensor that is supported: how it is set up, and its bytes as samples."""
