"""The effects of a joint, one file each."""
