"""Results for readers: printed answers, pages, figures and studies."""
