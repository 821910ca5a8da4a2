"""Tables of the page of beating hearts, a file a part."""
