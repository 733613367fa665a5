"""Tools by number, and what is known of them."""
