"""What all commands share: the requested scene, checked options, warnings and notes."""
