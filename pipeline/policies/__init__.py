"""Floor 5: environments to act in, policies that are trained in them, and the classical ways beside them."""
