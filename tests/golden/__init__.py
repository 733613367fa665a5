"""What every verb prints, writes and answers, frozen while its code is moved."""
