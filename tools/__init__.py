"""Small programs that keep the repository in order; nothing of the package imports them."""
