"""The parts of scripts/undertow: one module per idea, the commands in commands.py."""
