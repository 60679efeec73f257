"""Page of a skin: one file that any browser opens, in which the skin is pressed."""
