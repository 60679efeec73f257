"""Full models of all skins of a kind, whose matrices are sums of few: on squares, on triangles."""
