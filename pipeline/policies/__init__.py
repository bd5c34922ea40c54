"""Floor 6: environments, policies trained in them, and classical controllers for comparison."""
