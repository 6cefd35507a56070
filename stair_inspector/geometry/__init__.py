"""Mathematics that has never heard of stairs."""
