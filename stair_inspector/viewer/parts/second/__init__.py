"""A second scan of the stair beside the first: what changed between them."""
