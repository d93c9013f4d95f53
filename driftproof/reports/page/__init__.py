"""Scenes as one self-contained page of HTML: figures are drawn as SVG here, the style sheet is in this folder."""
