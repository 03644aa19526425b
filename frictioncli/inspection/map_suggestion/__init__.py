"""A first mapping file for a table of unknown columns, from their names and their physics."""
