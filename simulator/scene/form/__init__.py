"""What a skin is cut to, bent to, or meshed as."""
