"""The skin as a page: one file that any browser opens, in which the skin is pressed."""
