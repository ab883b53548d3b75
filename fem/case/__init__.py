"""The case file: tables, quantities, rules, overrides, files. It knows no mesh, no results and no solver."""
