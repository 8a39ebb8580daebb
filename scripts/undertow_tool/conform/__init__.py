"""undertow conform: plays the coupler against a participant and tells whether it keeps to docs/protocol.md."""
