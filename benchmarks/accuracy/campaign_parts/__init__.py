"""What the campaign is made of: scenes drawn at random, routes to the truth, and the verdict."""
