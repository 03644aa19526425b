"""The search for causes, from precomputed columns to hold-out and lack of fit."""
