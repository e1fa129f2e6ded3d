"""The home page: patients, their sessions and progress, deleting and recovering them."""
