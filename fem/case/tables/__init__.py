"""The tables of a case file: keys, quantities and the rules between them."""
