"""What viser has no public name for, and every script and style of the page."""
