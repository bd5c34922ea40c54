"""How fast the simulator is, measured in one run beside its peers (make bench)."""
