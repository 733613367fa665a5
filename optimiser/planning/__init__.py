"""Problem of each workingstep, and the search for its number of passes."""
