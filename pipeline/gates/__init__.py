"""Floor 2: gates, and the tracks that they make, for whoever flies through them or looks at them."""
