"""Scenes as one page of HTML that needs nothing else: figures are drawn as SVG here, styles are beside this file."""
