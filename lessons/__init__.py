"""What is taught: a folder per lesson, and the catalogue that finds them."""
