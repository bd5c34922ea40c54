"""Floor 5: environments, policies trained in them, and classical controllers for comparison."""
