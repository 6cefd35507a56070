"""The checks: which rules, what they come to, limits that were changed."""
