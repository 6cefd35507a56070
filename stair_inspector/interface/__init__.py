"""What ``import stair_inspector as si`` gives: from a file to values, and to a table, in Python.

It hands on to the rooms below what the command line hands on to them, so that both give the same numbers. It may import
every room but the page and the command line; the package looks its names up when they are asked for.
"""
