"""Public functions of `import rcskin`, with checks of their arguments."""
