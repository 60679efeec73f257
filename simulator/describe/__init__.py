"""What a scene is, in words and as a drawing."""
