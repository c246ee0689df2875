"""The verdict on a campaign: its content, its schema and its file; distances in dB."""
