"""Pictures of a skin's fields: maps, movies, files for ParaView, and pages to turn about."""
