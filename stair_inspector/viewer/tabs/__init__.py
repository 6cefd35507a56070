"""The tabs of the panel, one file each: what stands where, and whom it calls. Two of them show the table of steps."""
