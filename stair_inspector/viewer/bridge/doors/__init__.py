"""The doors of the server: who is let in, from where, and what a page may send."""
