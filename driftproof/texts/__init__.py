"""Numbers in texts: questions and answers, formatting, published values, and checks of texts against claims."""
