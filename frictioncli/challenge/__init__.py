"""Effects planted in a user's own logs, and what the diagnosis then says.

The laws are those of the simulator, which no entry of the catalogue equals; their shapes are drawn
to fit the speeds, temperatures, loads and angles of the log.
"""
