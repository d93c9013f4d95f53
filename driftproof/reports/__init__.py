"""What one would rather look at: pages, figures and studies."""
