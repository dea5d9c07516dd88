"""Files that somebody drops onto the page: surfaces, films, scenes."""
