"""Forward simulation of the experiment; shares no code with the model that is fitted."""
