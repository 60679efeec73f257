"""A meter that is not there: it speaks the IM3523's language over TCP about a skin it is given."""
