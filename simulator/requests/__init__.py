"""What all commands share: the scene they are asked for, and what they tell beside their work."""
