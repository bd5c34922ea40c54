"""Floor 1: pure functions on tensors for the mechanics and electrics that every machine shares.

Batch dimensions lead, components are last; float32 or float64, any device, differentiable. Constants are SI.
"""
