"""The page: everything that touches viser.

From the lowest room to the highest, each of which may import those before it: ``bridge`` (what is private to viser, and
every script and style of the page), ``compute`` (runs and the process that computes), ``state`` (the work on a scan and
its history), ``scene`` (what is drawn), ``parts`` (the tabs and what stands around them), ``page`` (one page, put
together of its parts) and ``app`` (the server).
"""
