"""Write outcomes, corrections or the table to a file; JSON and Parquet keep every value, CSV
puts an apostrophe before text that a spreadsheet would calculate."""
