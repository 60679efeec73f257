"""From depth or force of a press to the strain of the foam."""
