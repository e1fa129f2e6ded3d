"""The patient's goals: their page and what stores them."""
