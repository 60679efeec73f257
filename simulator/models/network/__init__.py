"""All contacts of a skin as one N-terminal network: trained once, read in any way."""
