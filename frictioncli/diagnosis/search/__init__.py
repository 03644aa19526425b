"""The search for causes: hypothesis tests step by step, selection by hold-out, lack of fit."""
