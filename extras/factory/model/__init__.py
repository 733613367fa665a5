"""Model of a shop: stations, crews, shifts, products and their parts."""
