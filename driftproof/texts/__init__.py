"""Numbers in texts: asked for, written, published, and held to claims."""
