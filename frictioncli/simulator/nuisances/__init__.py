"""Nuisances: what an ordinary joint and an ordinary log do besides friction by equation (16)."""
