"""Floor 6: which physics a simulator lacks: hypotheses, their scores, the search among them, and what is named."""
