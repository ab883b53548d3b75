"""The elastic body: elements, assembly, modes, reduction, nodal stepping. It knows no case and no floor."""
