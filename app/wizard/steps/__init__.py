"""One module per step: it joins a page, which knows nothing but what it is shown, to the visit."""
