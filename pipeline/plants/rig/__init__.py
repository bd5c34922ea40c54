"""A quadrotor in a gimbal: it turns about a point that stays where it is, as a pilot commands its rates."""
