"""Parts of a trained localizer: arrays and names that check and store themselves, and answer."""
