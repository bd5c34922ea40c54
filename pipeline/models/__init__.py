"""Floor 6: fitted and learned dynamics. Knows nothing of the diagnosis and of policies."""
