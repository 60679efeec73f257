"""Connection to a meter, conversation over it, and discovery of meters."""
