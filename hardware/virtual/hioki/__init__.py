"""Virtual LCR meters of Hioki: IM3523 and its siblings."""
