"""All contacts of a skin as one N-terminal network: trained once, for any interfaces."""
