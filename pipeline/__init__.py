"""What the stages are made of; see README.md for the floors of the house."""
