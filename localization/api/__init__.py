"""Public functions of `import rcskin`: they check their arguments and import what they need."""
