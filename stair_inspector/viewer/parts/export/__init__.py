"""What is taken away: files, pictures, the report, the project."""
