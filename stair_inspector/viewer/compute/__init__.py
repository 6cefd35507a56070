"""Who computes for the pages: threads and processes, runs and their progress, jobs."""
