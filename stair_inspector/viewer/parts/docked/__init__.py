"""What is docked below the scene."""
