"""Building maps and the generators that draw them."""
